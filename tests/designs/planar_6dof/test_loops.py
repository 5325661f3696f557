"""The open loops: those of the whole controller are the analytic ones and those of the emitted C; planted defects."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import allocation, interface, loops, lqg
from designs.planar_6dof_leadlag import control as leadlag
from models import planar_stage
from synth.analyse.loops import disk, stability_margins
from synth.analyse.loops import loop as analyse
from synth.block import Block
from synth.emit import write
from synth.errors import SignalError
from synth.execute import host
from synth.signals import signal_names
from synth.timing import Discrete
from tests.designs.planar_6dof import analytic

PLANT = planar_stage.plant()
HORIZONTAL = allocation.HORIZONTAL
NEAR = 1e-9  # relative: cancellation in the Jacobian of a pose that cancels
C = analytic.Transfer
Case = tuple[Block, Discrete, bool, Callable[[str], C]]


@pytest.fixture(scope="module")
def cases() -> dict[str, Case]:
    """Return for each design its controller, rate, whether it filters, and the compensators written out."""
    return {
        "leadlag": (leadlag.controller(PLANT), leadlag.TIME, True, lambda a: analytic.lead_lag(a, leadlag.TIME)),
        "lqg": (lqg.controller(PLANT), lqg.TIME, False, optimal),
    }


def optimal(axis: str) -> C:
    return analytic.optimal(PLANT, axis) if axis in HORIZONTAL else analytic.lead_lag(axis, lqg.TIME)


@pytest.fixture(scope="module")
def parts_of(cases: dict[str, Case]) -> dict[str, loops.LoopParts]:
    return {name: loops.parts(PLANT, block) for name, (block, *_) in cases.items()}


def circle(time: Discrete) -> np.ndarray:
    return np.exp(2j * np.pi * np.geomspace(0.3, 0.45 / time.period_s, 40) * time.period_s)


def distance(parts: loops.LoopParts, case: Case, axis: str) -> float:
    """Return how far the loop of a controller is from the one written out, of it or of 1 + L, at 40 frequencies."""
    _, time, filtered, compensator = case
    z = circle(time)
    expected = analytic.loop(PLANT, axis, compensator(axis), time, filtered)(z)
    response = loops.open_loop(parts, [axis]).response(z)[:, 0, 0]
    return float(np.abs(response / expected - 1).max())


# The loop of the whole controller is the one that is written out


@pytest.mark.parametrize("axis", allocation.AXES)
@pytest.mark.parametrize("name", ["leadlag", "lqg"])
def test_each_loop_is_the_analytic_one(
    cases: dict[str, Case], parts_of: dict[str, loops.LoopParts], name: str, axis: str
) -> None:
    assert distance(parts_of[name], cases[name], axis) < NEAR


@pytest.mark.parametrize("name", ["leadlag", "lqg"])
def test_the_loop_at_the_currents_is_the_analytic_one(
    cases: dict[str, Case], parts_of: dict[str, loops.LoopParts], name: str
) -> None:
    """Three currents, whose loop is a full matrix though that of the positions is diagonal."""
    _, time, filtered, compensator = cases[name]
    z, whole = circle(time), loops.horizontal(parts_of[name])
    single = {a: analytic.loop(PLANT, a, compensator(a), time, filtered) for a in HORIZONTAL}
    expected = analytic.currents(PLANT, single, z)
    response = whole["currents"].response(z)
    size = np.abs(expected).max(axis=(1, 2), keepdims=True)
    assert (np.abs(response - expected) / size).max() < NEAR
    assert (np.abs(expected[:, 1, 2]) / size[:, 0, 0]).max() > 0.1
    across = whole["positions"].response(z)
    assert np.abs(across[:, 0, 2] * PLANT.parameter("a").value).max() < NEAR * np.abs(across[:, 0, 0]).max()


@pytest.mark.parametrize("name", ["leadlag", "lqg"])
def test_the_linear_controller_is_that_of_the_emitted_c(cases: dict[str, Case], name: str) -> None:
    """Jacobians by central differences of the compiled C in double, from the state in which the platen rests."""
    block = cases[name][0]
    state, inputs = loops.rest_point(PLANT, block, loops.MIDDLE)
    expected = analyse.linearise_block(block, state, inputs)
    emitted = write.emit(block, np.float64, error=interface.SURROGATE_ERROR[np.float64])
    A, B, C, D = differences(host.load(emitted.files, emitted.manifest), block, state, inputs)
    linear = replace(expected, A=A, B=B, C=C, D=D)
    z = circle(cases[name][1])
    a, b = (m.select(m.outputs, loops.SENSED).response(z) for m in (linear, expected))
    size = np.abs(b).max(axis=1, keepdims=True)  # of the answer to each sensor, A/V or A/m; two of them do not matter
    assert (np.abs(a - b) / np.maximum(size, 1e-3)).max() < 1e-5  # central differences of 1e-7 of a range
    assert (size > 0.1).sum() == 7 * len(z)


def differences(
    controller: host.Controller, block: Block, state: dict[str, float], inputs: dict[str, float]
) -> list[np.ndarray]:
    """Return A, B, C, D of the C; flags and counters stay, and their columns are 0."""
    known, input_names = [s.name for s in block.states], signal_names(block.inputs)
    moved = [s.name for s in block.states if not s.integer] + list(input_names)
    steps = {s.name: 1e-7 * (s.signal.high - s.signal.low) for s in block.states}
    steps |= {s.name: 1e-7 * (s.high - s.low) for s in block.inputs}
    n = 2 * len(moved)
    records, columns = np.zeros(n, controller.state), {name: np.full(n, inputs[name]) for name in input_names}
    for name in known:
        records[name] = state[name]
    for k, name in enumerate(moved):
        at = columns[name] if name in columns else records[name]
        at[2 * k] += steps[name]
        at[2 * k + 1] -= steps[name]
    batch = controller.batch(records, columns)
    after = np.array([np.asarray(batch.states[s], dtype=float) for s in known])
    out = np.array([np.asarray(batch.outputs[s], dtype=float) for s in signal_names(block.outputs)])
    matrices = []
    for rows in (after, out):
        slopes = {m: (rows[:, 2 * k] - rows[:, 2 * k + 1]) / (2 * steps[m]) for k, m in enumerate(moved)}
        nothing = np.zeros(len(rows))
        matrices += [np.array([slopes.get(m, nothing) for m in part]).T for part in (known, input_names)]
    return matrices


def test_it_is_at_rest_wherever_the_platen_is(cases: dict[str, Case]) -> None:
    """At a place beside the middle as well: nothing is refused, and the currents are those of the sensors' error."""
    for block, *_ in cases.values():
        for place in (loops.MIDDLE, {"x": 0.011, "y": -0.02}):
            state, inputs = loops.rest_point(PLANT, block, place)
            x, u = [state[s.name] for s in block.states], [inputs[n] for n in signal_names(block.inputs)]
            after, y = (np.asarray(v).ravel() for v in block.function()(x, u))
            size = np.array([s.signal.high - s.signal.low for s in block.states])
            rests = [not s.name.startswith("sensing_watch_") for s in block.states]  # the watch over codes goes on
            assert np.abs(y).max() < 1e-3 and (np.abs(after - x) / size)[rests].max() < 1e-3
            assert state["guard_ready"] == 1 and not state["guard_latched"]


# What is made of a loop


def test_margins_over_a_pitch_scatter_little(parts_of: dict[str, loops.LoopParts], cases: dict[str, Case]) -> None:
    """The calibrated slope of x is off by a few per cent at most, and so is the crossover."""
    middle = stability_margins.of_loop(loops.open_loop(parts_of["leadlag"], ["x"]))
    places = loops.places_over_pitch(PLANT.parameter("l").value, 3)
    each_place = [loops.parts(PLANT, cases["leadlag"][0], place) for place in places]
    by_place = [stability_margins.of_loop(loops.open_loop(both, ["x"])) for both in each_place]
    for margins in by_place:
        assert margins.stable and margins.phase_margin == pytest.approx(middle.phase_margin, abs=3)
    assert len({margins.phase_margin for margins in by_place}) > 1


def test_disk_margins_of_a_diagonal_loop_are_those_of_its_axes(parts_of: dict[str, loops.LoopParts]) -> None:
    whole = loops.horizontal(parts_of["lqg"])
    disks = {name: disk.of_loop(L) for name, L in whole.items()}
    alone = [disk.of_loop(loops.open_loop(parts_of["lqg"], [a])).lower for a in HORIZONTAL]
    assert disks["positions"].lower == pytest.approx(min(alone), rel=1e-3)
    assert disks["both"].lower < 0.6 * disks["positions"].lower
    assert all(m.certified for m in disks.values())
    for name, m in disks.items():  # the factors found put a pole onto the unit circle
        L = whole[name]
        value = L.response([np.exp(1j * m.frequency * lqg.TIME.period_s)])[0]
        assert abs(np.linalg.det(np.eye(len(value)) + value @ np.diag(m.factors))) < 1e-3


def test_a_scaled_loop_has_the_same_diagonal_and_disk_margin(parts_of: dict[str, loops.LoopParts]) -> None:
    L = loops.horizontal(parts_of["lqg"])["currents"]
    z, other = circle(lqg.TIME), loops.scaled(L, {"i_CQ": 0.01})
    a, b = L.response(z), other.response(z)
    np.testing.assert_allclose(np.diagonal(a, axis1=1, axis2=2), np.diagonal(b, axis1=1, axis2=2), rtol=1e-9)
    np.testing.assert_allclose(b[:, 2, 0], 0.01 * a[:, 2, 0], rtol=1e-9)


def test_a_signal_that_does_not_go_around_is_refused(parts_of: dict[str, loops.LoopParts]) -> None:
    with pytest.raises(
        SignalError, match=r"cannot open at 'x_raw', which is neither .*: name one of x, y, phi, z, theta, psi, i_AQ"
    ):
        loops.open_loop(parts_of["lqg"], ["x_raw"])


# Planted defects
