"""Emission is deterministic, rounds once, scales linearly with the Block, and writes only files that change."""

import json
import subprocess
import sys
from pathlib import Path
from types import FrameType
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.composition import compose
from synth.emit import pipeline
from synth.emit.passes import surrogates
from synth.emit.proof import libm
from synth.emit.write import emit, save
from synth.errors import EmitError, SignalError
from synth.signals import Signal
from synth.timing import Discrete

FLOATS = [np.float32, np.float64]
OWN = str(Path(pipeline.__file__).parent)


def filter_block(k: float = 0.1, high: float = 3.0) -> Block:
    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        lag = x["lag"] + k["k"] * (u["a"] - x["lag"])
        return Step({"y": ca.sin(lag) + lag}, {"lag": lag})

    a, lag, y = Signal("a", "1", -2, 2), Signal("lag", "1", -2, 2), Signal("y", "1", -high, high)
    constants = [Constant("k", k, "1", "a tenth")]
    return build("lagged", Discrete(1e-3), law, inputs=[a], outputs=[y], states=[State(lag, 0)], constants=constants)


@pytest.mark.parametrize("scalar", FLOATS)
def test_the_same_block_gives_the_same_bytes(scalar: type[np.floating]) -> None:
    first, again = emit(filter_block(), scalar), emit(filter_block(), scalar)
    assert first == again
    assert set(first.files) == {"lagged.c", "lagged.h", "lagged.md", "manifest.json", "gains.json"}


def test_another_process_gives_the_same_bytes() -> None:
    program = (
        "import importlib.util, json, sys, numpy\n"
        "spec = importlib.util.spec_from_file_location('t', sys.argv[1])\n"
        "t = importlib.util.module_from_spec(spec)\n"
        "spec.loader.exec_module(t)\n"
        "print(json.dumps(dict(t.emit(t.filter_block(), numpy.float32).files)))\n"
    )
    done = subprocess.run([sys.executable, "-c", program, __file__], capture_output=True, text=True, check=True)
    assert json.loads(done.stdout) == dict(emit(filter_block(), np.float32).files)


@pytest.mark.parametrize("scalar", FLOATS)
def test_constants_are_rounded_once_and_documented_as_rounded(scalar: type[np.floating]) -> None:
    made = emit(filter_block(), scalar, gains={"weights": {"lag": 2}})
    gains = json.loads(made.files["gains.json"])
    assert gains == {
        "constants": {"k": {"value": float(scalar(0.1)), "unit": "1", "from": "a tenth"}},
        "weights": {"lag": 2},
    }
    assert ("k = 0.1f;" if scalar is np.float32 else "k = 0.1;") in made.files["lagged.c"]


def test_a_number_that_the_type_cannot_represent_is_refused() -> None:
    with pytest.raises(EmitError, match=r"choose numpy\.float32"):
        emit(filter_block(), np.float16)
    with pytest.raises(SignalError, match="constant 'k' is inf"):
        emit(filter_block(1e39), np.float32)
    assert "k = 1e+39;" in emit(filter_block(1e39, 1e40), np.float64, libm=True).files["lagged.c"]


def axis(i: int) -> Block:
    """Return a filter, a law with anti-windup and a counter for one axis of many, with a function of its gap."""

    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        live, e = u["live"], u[f"gap{i}"] - u[f"wish{i}"]
        de = x["f"] + k["h"] * (e - x["e"])
        force = ca.exp(-u[f"gap{i}"]) * (k["ke"] * e + k["kd"] * de + k["ki"] * x["sum"])
        next = {"e": ca.if_else(live, e, x["e"]), "f": ca.if_else(live, de, x["f"])}
        next |= {"sum": ca.if_else(ca.fabs(x["sum"] + e) <= 3, x["sum"] + e, x["sum"])}
        next |= {"n": ca.if_else(live, ca.fmin(x["n"] + 1, 7), 0)}
        return Step({f"force{i}": ca.fmax(ca.fmin(force, 5), -5)}, next, [(Signal(f"e{i}", "1", -2, 2), e)])

    bounds = {"e": 2.0, "f": 50.0, "sum": 3.0}
    states = [*(State(Signal(n, "1", -b, b), 0) for n, b in bounds.items()), State(Signal("n", "1", 0, 7), 0, True)]
    constants = [Constant(n, v, "1", "test") for n, v in (("h", 0.5), ("ke", 2.5), ("kd", 0.25), ("ki", 0.125))]
    inputs = [Signal(n, "1", 0, 1) for n in (f"gap{i}", f"wish{i}", "live")]
    outputs = [Signal(f"force{i}", "1", -5, 5)]
    return build(
        f"axis{i}", Discrete(1e-3), law, inputs=inputs, outputs=outputs, states=states, constants=constants, tag="law"
    )


def axes(n: int) -> Block:
    inputs = [f"{name}{i}" for i in range(n) for name in ("gap", "wish")] + ["live"]
    blocks = [axis(i) for i in range(n)]
    return compose("axes", blocks, inputs=inputs, outputs=[f"force{i}" for i in range(n)])


def work(n: int) -> dict[str, int]:
    """Return the lines of the C of n axes, the nodes of their program, and the calls that emission makes of itself."""
    block, calls = axes(n), 0
    libm._kept_transfer.cache_clear()  # what fewer axes have left is no work

    def count(frame: FrameType, event: str, _: object) -> None:
        nonlocal calls
        calls += event == "call" and OWN in frame.f_code.co_filename

    sys.setprofile(count)
    try:
        made = emit(block, np.float32, error=1e-3)
    finally:
        sys.setprofile(None)
    nodes = len(pipeline.reduce(block.rounded(np.float32), np.float32, error=1e-3).program.nodes)
    return {"lines": made.files["axes.c"].count("\n"), "nodes": nodes, "calls": calls}


def growth() -> dict[str, float]:
    """Return the ratios of these numbers for four times as many axes."""
    emit(axes(1), np.float32, error=1e-3)  # the axes' one function is fitted once
    few, many = work(6), work(24)
    return {what: many[what] / few[what] for what in few}


@pytest.fixture
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Emission computes everything: a result from the cache would not count as work."""
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path))


@pytest.mark.slow
@pytest.mark.usefixtures("empty_cache")
def test_emission_grows_linearly_with_the_number_of_axes() -> None:
    ratios = growth()
    assert 3.1 < ratios["nodes"] < 4.05 and 3.1 < ratios["calls"] < 4.05, ratios
    assert 1 < ratios["lines"] < 4.05, ratios  # what the axes share is printed once


@pytest.mark.slow
@pytest.mark.usefixtures("empty_cache")
def test_a_search_through_all_nodes_for_each_axis_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = surrogates._candidate_variables

    def searched(program: Any, users: Any, node_ranges: Any, f: Any) -> Any:
        for k in range(len(program.nodes)):
            surrogates._reciprocal(program, k, f.variable)
        return plain(program, users, node_ranges, f)

    monkeypatch.setattr(surrogates, "_candidate_variables", searched)
    assert growth()["calls"] > 3.7


def test_axes_share_their_function_and_their_branch() -> None:
    text = emit(axes(5), np.float32, error=1e-3).files["axes.c"]
    assert text.count("_polynomial(float t)") == 1 and text.count("_polynomial(") == 2
    assert text.count("if (!axes_equal(live, 0.0f))") == 1


def test_only_changed_files_are_written(tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "er"
    save({"a.c": "one\n", "b.h": "two\n"}, folder)
    (folder / "a.c").chmod(0o444)
    before = (folder / "a.c").stat().st_mtime_ns
    save({"a.c": "one\n", "b.h": "three\n"}, folder)
    assert (folder / "a.c").stat().st_mtime_ns == before
    assert {p.name: p.read_text() for p in folder.iterdir()} == {"a.c": "one\n", "b.h": "three\n"}
