"""The step on an emulated core must give the bits of the host's step, and its cost."""

import json
import re
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import State, Step, build
from synth.emit.write import emit
from synth.errors import CompileError, DesignError, SignalError, SynthError
from synth.execute import host, target
from synth.signals import Signal
from synth.timing import Discrete
from tests import tools
from tests.execute.planted import lag

SCALARS = {"cortex-m4f": "float32", "cortex-m7": "float64"}
MAGLEV = Path(__file__).parents[2] / "generated_c" / "maglev_5dof"
MATH_CALL = re.compile(r"\b(\w+f)\(")


def samples(n: int, scalar: str) -> dict[str, Any]:
    """Inputs inside and outside the guard, among them infinite, subnormal and negative zero."""
    rng = np.random.default_rng(5)
    u, gain = rng.normal(size=n), rng.normal(size=n)
    tiny = np.finfo(scalar).smallest_subnormal
    u[::50], u[7::50], u[9::50] = np.inf, -0.0, 3 * tiny
    gain[3::20] *= tiny / np.finfo(scalar).eps
    return {"u": u.astype(scalar), "gain": gain.astype(scalar)}


def require_same_bits(actual: host.Replay, expected: host.Replay) -> None:
    for name, column in expected.outputs.items():
        assert actual.outputs[name].dtype == column.dtype
        assert actual.outputs[name].tobytes() == column.tobytes(), name
    assert np.array_equal(actual.faults, expected.faults) and actual.state.tobytes() == expected.state.tobytes()


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
@pytest.mark.parametrize("core", SCALARS)
def test_the_core_gives_the_bits_of_the_host(core: str, compiler: str) -> None:
    files, manifest = lag(SCALARS[core])
    inputs = samples(2000, SCALARS[core])
    expected = host.load(files, manifest).replay(inputs)
    emulated = target.load(files, manifest, core, compiler)
    require_same_bits(emulated.replay(inputs), expected)
    require_same_bits(emulated.measure(inputs).replay, expected)
    assert 0 < np.count_nonzero(expected.faults & 1) < 200  # the guard was at work
    assert emulated.init().tobytes() == host.load(files, manifest).init().tobytes()


def test_a_contracted_product_is_seen() -> None:
    """The planted defect: a fused multiply-add rounds once where the host rounds twice."""
    files, manifest = lag("float64")
    inputs = samples(200, "float64")
    fused = target.load(files, manifest, "cortex-m7", "zig", ["-ffp-contract=fast"]).replay(inputs)
    with pytest.raises(AssertionError):
        require_same_bits(fused, host.load(files, manifest).replay(inputs))


def test_a_core_that_flushes_to_zero_is_refused() -> None:
    files, manifest = lag("float32")
    flushing = files["lag.c"].replace(
        "    const int good",
        '    uint32_t fpscr; __asm__ volatile("vmrs %0, fpscr" : "=r"(fpscr));\n'
        '    __asm__ volatile("vmsr fpscr, %0" : : "r"(fpscr | 1u << 24));\n    const int good',
    )
    broken = target.load(files | {"lag.c": flushing}, manifest)
    with pytest.raises(SynthError, match="mode bits 0x1000000"):
        broken.replay(samples(3, "float32"))


def test_replay_in_two_parts_leaves_the_given_state() -> None:
    files, manifest = lag("float32")
    emulated, inputs = target.load(files, manifest), samples(40, "float32")
    whole, first = emulated.replay(inputs), emulated.replay({n: v[:17] for n, v in inputs.items()})
    before = first.state.tobytes()
    second = emulated.replay({n: v[17:] for n, v in inputs.items()}, first.state)
    assert np.array_equal(whole.outputs["y"], np.concatenate([first.outputs["y"], second.outputs["y"]]))
    assert first.state.tobytes() == before and second.state.tobytes() == whole.state.tobytes()


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_an_emitted_block_in_double_on_the_cortex_m7(compiler: str) -> None:
    def law(u: dict[str, ca.SX], x: dict[str, ca.SX], k: dict[str, ca.SX]) -> Step:
        slow = x["slow"] + 0.1 * (u["a"] - x["slow"])
        return Step({"y": ca.sqrt(ca.fabs(slow)) + u["b"] / (2 + slow)}, {"slow": ca.fmin(ca.fmax(slow, -1), 1)})

    a, b, slow = (Signal(name, "1", -1, 1) for name in ("a", "b", "slow"))
    y = Signal("y", "1", -1, 3)
    block = build("slow", Discrete(1e-3), law, inputs=[a, b], outputs=[y], states=[State(slow, 0.25)], constants=[])
    made = emit(block, np.float64)
    inputs = {n: np.random.default_rng(6).uniform(-1, 1, 500) for n in ("a", "b")}
    expected = host.load(made.files, made.manifest).replay(inputs)
    measured = target.load(made.files, made.manifest, "cortex-m7", compiler).measure(inputs)
    require_same_bits(measured.replay, expected)
    assert 15 <= measured.cost.instructions.max() < 60 and measured.cost.cycles is None


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_the_recorded_steps_of_a_design(compiler: str) -> None:
    """Libm differs between machines; as long as the C calls it, the last bits differ."""
    files = {path.name: path.read_text() for path in MAGLEV.glob("*.[ch]")}
    manifest = json.loads((MAGLEV / "manifest.json").read_text())
    inputs = json.loads((MAGLEV / "vectors.json").read_text())["inputs"]
    expected = host.load(files, manifest).replay(inputs)
    replay, cost = target.load(files, manifest, "cortex-m4f", compiler).measure(inputs)
    assert cost.instructions.shape == (1000,) and cost.stack_bytes > 0 and cost.cycles is not None
    assert np.all(cost.instructions < cost.cycles.high) and np.all(cost.cycles.low <= cost.cycles.high)
    if not set(MATH_CALL.findall(files["maglev_5dof.c"])) - {"sqrtf", "fabsf", "sizeof"}:
        require_same_bits(replay, expected)
        return
    assert np.array_equal(replay.faults, expected.faults)
    for field in manifest["structs"]["output"]["fields"]:
        # A feedback through a few libm calls, each off by an ulp or two: 1e-5 of the range is a hundred ulps.
        gap = np.abs(replay.outputs[field["name"]] - expected.outputs[field["name"]])
        assert gap.max() <= 1e-5 * (field["high"] - field["low"])


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_cost_of_a_step(compiler: str) -> None:
    files, manifest = lag("float32")
    quiet = {"u": np.full(5, 0.1), "gain": np.full(5, 0.5)}
    cost = target.load(files, manifest, "cortex-m4f", compiler).measure(quiet).cost
    assert len(set(cost.instructions.tolist())) == 1 and 60 < cost.instructions[0] < 200  # the path is always the same
    assert np.array_equal(sum(cost.by_function.values()), cost.instructions)
    assert cost.missing and {site.function for site in cost.sites} <= {"lag_step", "root"}
    lively = target.load(files, manifest, "cortex-m4f", compiler).measure(
        {"u": [0.1, np.inf, -np.inf, 1.9, 1.9, 1.9, -1.9, -1.9, -1.9], "gain": [0.5, 1, 1, 9, 9, 9, 9, 9, 9]}
    )
    assert not lively.cost.missing, lively.cost.missing
    assert len(lively.cost.sites) == len(cost.sites)


def test_functions_reached_only_by_init_are_not_counted() -> None:
    files, manifest = lag("float32")
    pick = "unsigned pick(unsigned n);\nunsigned pick(unsigned n) { return n > 9u ? n * n : 7u; }\n"
    init = files["lag.c"].replace("state->ticks = 7u", "unsigned pick(unsigned n); state->ticks = pick(state->bad)")
    emulated = target.load(files | {"pick.c": pick, "lag.c": init}, manifest)
    assert emulated.init()["ticks"] == 7
    cost = emulated.measure({"u": np.zeros(2), "gain": 1.0}).cost
    assert {site.function for site in cost.sites} <= {"lag_step", "root"} and "pick" not in cost.by_function


def test_a_layout_that_the_core_does_not_have_is_refused() -> None:
    files, manifest = lag("float32")
    with pytest.raises(CompileError, match="manifest_state_ticks_at_8"):
        wrong = json.loads(json.dumps(manifest))
        wrong["structs"]["state"]["fields"][2]["offset"] = 8
        wrong["structs"]["state"]["fields"][1]["offset"] = 12
        target.load(files, wrong)
    with pytest.raises(DesignError, match="struct 'input'"):
        target.load(files, {**manifest, "structs": {}})
    with pytest.raises(CompileError, match="no function 'lag_start'"):
        target.load(files, {**manifest, "functions": {"init": "lag_start", "step": "lag_step"}})


def test_inputs_and_states_that_do_not_fit_are_named() -> None:
    files, manifest = lag("float32")
    emulated = target.load(files, manifest)
    for run in (emulated.replay, emulated.measure):
        with pytest.raises(SignalError, match=r"missing \['gain'\]"):
            run({"u": np.zeros(3)})
        with pytest.raises(SignalError, match="lengths"):
            run({"u": np.zeros(3), "gain": np.zeros(4)})
        with pytest.raises(SignalError, match="state of 'lag'"):
            run({"u": np.zeros(3), "gain": 0.0}, np.zeros(2))
    with pytest.raises(SignalError, match="found 0 calls"):
        emulated.measure({"u": np.zeros(0), "gain": np.zeros(0)})
    assert emulated.replay({"u": np.zeros(0), "gain": np.zeros(0)}).faults.size == 0
