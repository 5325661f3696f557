"""Emission is deterministic, rounds once, and touches only the files that change."""

import json
import subprocess
import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.emit.write import emit, save
from synth.errors import EmitError, SignalError
from synth.signals import Signal
from synth.timing import Discrete

FLOATS = [np.float32, np.float64]


def filter_block(k: float = 0.1) -> Block:
    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        lag = x["lag"] + k["k"] * (u["a"] - x["lag"])
        return Step({"y": ca.sin(lag) + lag}, {"lag": lag})

    a, y, lag = (Signal(name, "1", -2, 2) for name in ("a", "y", "lag"))
    constants = [Constant("k", k, "1", "a tenth")]
    return build("lagged", Discrete(1e-3), law, inputs=[a], outputs=[y], states=[State(lag, 0)], constants=constants)


@pytest.mark.parametrize("scalar", FLOATS)
def test_the_same_block_gives_the_same_bytes(scalar: type[np.floating]) -> None:
    first, again = emit(filter_block(), scalar), emit(filter_block(), scalar)
    assert first == again
    assert set(first.files) == {"lagged.c", "lagged.h", "manifest.json", "gains.json"}


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
def test_constants_are_rounded_once_and_shipped_as_rounded(scalar: type[np.floating]) -> None:
    made = emit(filter_block(), scalar, gains={"weights": {"lag": 2}})
    gains = json.loads(made.files["gains.json"])
    assert gains == {
        "constants": {"k": {"value": float(scalar(0.1)), "unit": "1", "from": "a tenth"}},
        "weights": {"lag": 2},
    }
    assert ("k = 0.1f;" if scalar is np.float32 else "k = 0.1;") in made.files["lagged.c"]


def test_what_a_type_cannot_hold_is_refused() -> None:
    with pytest.raises(EmitError, match=r"choose numpy\.float32"):
        emit(filter_block(), np.float16)
    with pytest.raises(SignalError, match="constant 'k' is inf"):
        emit(filter_block(1e39), np.float32)
    assert "k = 1e+39;" in emit(filter_block(1e39), np.float64).files["lagged.c"]


def test_only_changed_files_are_written(tmp_path: Path) -> None:
    folder = tmp_path / "deep" / "er"
    save({"a.c": "one\n", "b.h": "two\n"}, folder)
    (folder / "a.c").chmod(0o444)
    before = (folder / "a.c").stat().st_mtime_ns
    save({"a.c": "one\n", "b.h": "three\n"}, folder)
    assert (folder / "a.c").stat().st_mtime_ns == before
    assert {p.name: p.read_text() for p in folder.iterdir()} == {"a.c": "one\n", "b.h": "three\n"}
