"""The filters as Blocks and as C, against recursions of their own.

raw ---> [ filter ] ---> filtered, predicted        rest: where the raw position is, until ready
"""

import re
from collections.abc import Callable

import numpy as np
import pytest

from designs.planar_6dof import filtering, reference_sensing
from synth.block import Block, unranged
from synth.composition import compose
from synth.emit import write
from synth.execute import compile as compiler
from synth.execute import host
from synth.statespace import Array
from synth.timing import Discrete
from tests import tolerances

RATES = (800, 1000)
AXES = filtering.AXES
LONG = 100_000  # samples
EXACT = tolerances.of("double")
SINGLE = 1e-7  # m: the noise after the filter is 1.5e-5 m, the smallest step asked of the stage 2e-5 m


def alone(axis: str, rate: int) -> Block:
    """A filter whose prediction is an output, too."""
    part = filtering.block(axis, Discrete(1 / rate))
    return compose("filtered", [part], inputs=[f"{axis}_raw", "ready"], outputs=[axis, f"{axis}_predicted"])


def compiled(axis: str, rate: int, scalar: type[np.floating], change: Callable[[str], str] = str) -> host.Controller:
    made = write.emit(unranged(alone(axis, rate)), scalar)
    return host.load(dict(made.files) | {"filtered.c": change(made.files["filtered.c"])}, made.manifest)


def recursion(axis: str, T: float, updated: bool) -> tuple[Array, Array]:
    """Iterate (14) and (16) from (15) to rest; return K (3,) and P. Without the update, as printed, 20 s."""
    A = np.array([[1, T, T**2 / 2], [0, 1, T], [0, 0, 1]])
    Gamma = np.array([T**3 / 6, T**2 / 2, T])
    R, P = 5e-5**2, 1e8 * np.eye(3)
    for _ in range(round(20 / T) if not updated else 2000):
        K = P[:, 0] / (P[0, 0] + R)
        # Joseph's form: (I - K C) P loses its symmetry within 1e8 to 1e-9.
        rest = np.eye(3) - np.outer(K, [1, 0, 0])
        P = rest @ P @ rest.T + R * np.outer(K, K) if updated else P
        P = A @ P @ A.T + filtering.JERK[axis] * np.outer(Gamma, Gamma)
    return K, P


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize("axis", AXES)
def test_the_gains_are_where_the_recursion_comes_to_rest(axis: str, rate: int) -> None:
    T = 1 / rate
    K, _ = recursion(axis, T, updated=True)
    shipped = {c.name: c.value for c in filtering.block(axis, Discrete(T)).constants}
    gains = [shipped[f"k_{n}"] for n in "psh"]
    np.testing.assert_allclose(gains, K * [1, T, T**2 / 2], rtol=1e-6)  # the recursion's own rounding
    np.testing.assert_allclose(gains, reference_sensing.gain(filtering.JERK[axis], T), rtol=EXACT)


def test_as_printed_nothing_is_filtered() -> None:
    K, P = recursion("x", 1 / 800, updated=False)
    assert K[0] > 1 - 1e-12 and P[0, 0] > 1e10  # m^2: it grows without end


@pytest.mark.parametrize("axis", AXES)
def test_the_block_is_the_current_form_of_the_filter(axis: str) -> None:
    time = Discrete(1 / 800)
    model = filtering.estimator(axis, time).current()
    raw = np.random.default_rng(0).uniform(-0.02, 0.02, 400)
    run = compiled(axis, 800, np.float64).replay({f"{axis}_raw": raw, "ready": 1.0})
    x, expected = np.zeros(3), []
    for y in raw:
        expected.append((model.C @ x + model.D[:, 0] * y)[0])
        x = model.A @ x + model.B[:, 0] * y
    np.testing.assert_allclose(run.outputs[axis], expected, atol=EXACT)
    assert run.outputs[f"{axis}_predicted"][0] == 0  # of the first sample it knows nothing


@pytest.mark.parametrize(("rate", "ratio"), [(800, 0.33906), (1000, 0.30502)])
def test_the_block_takes_as_much_noise_away_as_the_published_filter(rate: int, ratio: float) -> None:
    impulse = np.zeros(2000)
    impulse[0] = 1e-3
    answer = compiled("x", rate, np.float64).replay({"x_raw": impulse, "ready": 1.0}).outputs["x"]
    assert np.linalg.norm(answer) / 1e-3 == pytest.approx(ratio, abs=5e-6)  # Y-15


@pytest.mark.parametrize("axis", AXES)
def test_it_rests_at_the_raw_position_until_it_is_ready(axis: str) -> None:
    raw = np.array([0.01, -0.02, 0.015, 0.015, 0.015])
    run = compiled(axis, 800, np.float64).replay({f"{axis}_raw": raw, "ready": [0.0, 0.0, 1.0, 1.0, 1.0]})
    assert run.outputs[axis][:2].tolist() == [0.01, -0.02]
    assert run.outputs[f"{axis}_predicted"].tolist()[:3] == [0.0, 0.01, -0.02]
    fresh = compiled(axis, 800, np.float64).replay({f"{axis}_raw": [-0.02, 0.015], "ready": [0.0, 1.0]})
    assert run.outputs[axis][2] == fresh.outputs[axis][1]  # nothing is left of what came before


@pytest.mark.parametrize("axis", AXES)
def test_it_restarts_before_a_state_leaves_its_bounds(axis: str) -> None:
    controller = compiled(axis, 800, np.float32)
    raw, *_ = controller.manifest["structs"]["input"]["fields"]
    highs = np.array([f["high"] for f in controller.manifest["structs"]["state"]["fields"]])
    turns = np.cumsum(np.random.default_rng(0).integers(5, 50, 300))
    swings = raw["high"] * np.where(np.searchsorted(turns, np.arange(3000)) % 2, 1.0, -1.0)
    state = controller.init()
    restarts = 0
    for value in swings.astype(np.float32):
        controller.step(state, {f"{axis}_raw": value, "ready": 1.0})
        values = [float(state[n]) for n in state.dtype.names or ()]
        assert (np.abs(values) <= highs * (1 + 1e-7)).all()
        restarts += values == [value, 0.0, 0.0]
    assert restarts > 0


def travel(axis: str, rate: int, noise: float) -> Array:
    """The raw position on a circle of 200 mm, or a yaw of 15 mrad, for LONG samples, noisy."""
    time, size = np.arange(LONG) / rate, 0.015 if axis == "phi" else 0.1
    raw = size * np.cos(0.2094 * time) + noise * np.random.default_rng(rate).normal(size=LONG)
    return raw.astype(np.float32).astype(float)


def single_less_double(axis: str, rate: int, noise: float, change: Callable[[str], str] = str) -> float:
    inputs = {f"{axis}_raw": travel(axis, rate, noise), "ready": np.arange(LONG) > 0}
    single, double = compiled(axis, rate, np.float32, change), compiled(axis, rate, np.float64)
    gap = single.replay(inputs).outputs[axis].astype(float) - double.replay(inputs).outputs[axis]
    return float(np.abs(gap).max())


@pytest.mark.parametrize("rate", RATES)
@pytest.mark.parametrize(("axis", "noise"), [("x", 0.0), ("x", 5e-5), ("phi", 0.0), ("phi", 2e-3)])
def test_single_precision_is_as_good_as_double(axis: str, noise: float, rate: int) -> None:
    assert single_less_double(axis, rate, noise) < (SINGLE if axis == "x" else SINGLE / 10)


def from_positions(text: str) -> str:
    """Return C whose velocity is the difference of predicted and filtered position: s = (v + a) + a, v + a = p+ - x."""

    def stored(member: str) -> str:
        match = re.search(rf"{member} = (\w+);", text)
        assert match
        return match[1]

    now, predicted, a = stored("out->x"), stored("state->filter_x_p"), stored("state->filter_x_h")
    moved, count = re.subn(r"(state->filter_x_s = )[a-z]\w+;", rf"\g<1>({predicted} - {now}) + {a};", text)
    assert count == 1
    return moved


def test_a_velocity_taken_from_positions_is_not_as_good_and_is_seen() -> None:
    inputs = {"x_raw": travel("x", 800, 0.0)[:2000], "ready": 1.0}
    same = compiled("x", 800, np.float64, from_positions).replay(inputs).outputs["x"]
    np.testing.assert_allclose(same, compiled("x", 800, np.float64).replay(inputs).outputs["x"], rtol=0, atol=EXACT)
    assert single_less_double("x", 800, 0.0, from_positions) > SINGLE


def test_the_c_is_free_of_warnings_and_stores_no_product() -> None:
    made = write.emit(unranged(alone("x", 800)), np.float32)
    compiler.check(host.code(made.files))
    assert [s["name"] for s in made.manifest["structs"]["state"]["fields"]] == [
        "filter_x_p",
        "filter_x_s",
        "filter_x_h",
    ]
