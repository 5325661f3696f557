"""The LQG controller: (49), poles, margins, what the paper's own choices come to."""

from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import allocation, lqg, random_steps
from designs.planar_6dof_lqg import reference
from designs.planar_6dof_lqg.core import REGULATORS, Order
from synth.analyse.loops import loop
from synth.block import Block
from synth.errors import ModelError
from synth.execute import host
from synth.synthesise.observers import reduced_observer
from synth.verify import agree
from tests import tolerances
from tests.designs.planar_6dof import ideal_loops, ideal_runs

DOUBLE = tolerances.of("double")
PLANT = ideal_loops.PLANT
PRINTED = {  # (49), with the decimals that the scan lost: value and last digit, in the order x y phi z1 z2 z3 d f v
    (0, 1): (507.24, 2), (0, 2): (472.64, 2), (0, 4): (19975, 0), (0, 5): (41394, 0), (0, 7): (6.4304, 4),
    (0, 8): (2.6962, 4), (2, 0): (1757.55, 2), (2, 3): (84872, 0), (2, 6): (18.1556, 4),
}  # fmt: skip
# axis: crossover in Hz, phase margin in degrees, gain margin, peak sensitivity, with a sample of delay
MARGINS = {
    "reduced": {"x": (24.74, 33.4, 3.35, 1.82), "y": (19.78, 34.2, 4.10, 1.74), "phi": (32.49, 33.3, 2.92, 1.84)},
    "full": {"x": (27.20, 34.3, 2.57, 1.88), "y": (21.42, 36.4, 3.14, 1.69), "phi": (31.52, 22.4, 2.11, 2.68)},
}
PEAKS = {  # of the sensitivity by p, as the module's text has them
    "x": {0.0: 1.56, 0.5: 1.71, 0.7: 1.82, 0.8: 1.90, 0.9: 1.96},
    "y": {0.0: 1.43, 0.5: 1.58, 0.7: 1.74, 0.8: 1.87, 0.9: 2.02},
    "phi": {0.0: 2.20, 0.5: 2.12, 0.7: 2.03, 0.8: 1.96, 0.9: 1.84},
}
CURRENTS = {  # A rms by p, as the module's text has them
    "x": {0.0: 0.39, 0.5: 0.17, 0.7: 0.11, 0.8: 0.08, 0.9: 0.05},
    "phi": {0.0: 2.01, 0.5: 0.92, 0.7: 0.60, 0.8: 0.46, 0.9: 0.33},
}
INERTIA = {"x": "M", "y": "M", "phi": "Izz"}
NOISE = {"x": 13e-6, "phi": 0.3e-3}  # m, rad rms
HEIGHTS = {"x": 50e-6, "y": 50e-6, "phi": np.radians(0.3)}


@pytest.fixture(scope="module")
def known() -> host.Controller:
    return ideal_runs.compile_law(lqg.law(PLANT), lqg.TIME)


def test_the_gain_is_that_of_49() -> None:
    K = -lqg.gain().K
    for (i, j), (value, digits) in PRINTED.items():
        size = abs(K[i, j])
        assert size == pytest.approx(value, abs=tolerances.of("print_K") * 10.0**-digits), lqg.STATES[j]
    np.testing.assert_array_equal(K[1], K[0] * np.array([1, 1, -1, 1, 1, -1, 1, 1, -1]))
    zeros = [(i, j) for i in range(3) for j in range(9) if (min(i, 1) * 2, j) not in PRINTED and i != 1]
    assert not any(K[i, j] for i, j in zeros)


def test_the_printed_weights_do_not_make_49() -> None:
    K = np.abs(lqg.gain(lqg.PRINTED_WEIGHTS).K)
    assert K[2, 0] == pytest.approx(898.22, rel=1e-4) and K[0, 1] == pytest.approx(316.06, rel=1e-4)
    assert K[2, 0] < 0.6 * PRINTED[2, 0][0]


def test_demands_fall_apart_into_axes() -> None:
    K, diagonal = lqg.demand_gain(PLANT), np.zeros((3, 9), dtype=bool)
    for i in range(3):
        diagonal[i, [i, 3 + i, 6 + i]] = True
    assert not K[~diagonal].any() and (K[diagonal] < 0).all()
    per_ampere = [allocation.scales(PLANT)[a] / PLANT.parameter(n).value for a, n in INERTIA.items()]
    np.testing.assert_allclose([a.b for a in lqg.axes(PLANT)], per_ampere, rtol=DOUBLE)
    assert list(INERTIA) == [a.name for a in lqg.axes(PLANT)]
    for i, (a, scale) in enumerate(zip(lqg.axes(PLANT), allocation.scales(PLANT).values(), strict=False)):
        gains = scale * np.array([a.k1, a.k3 / lqg.TIME.period_s, a.k2])
        np.testing.assert_allclose(gains, -K[i, [i, 3 + i, 6 + i]], rtol=DOUBLE)


@pytest.mark.parametrize("order", MARGINS)
@pytest.mark.parametrize("axis", allocation.HORIZONTAL)
def test_margins(order: Order, axis: str) -> None:
    margins = ideal_loops.margins_of(lqg.law(PLANT, regulate=REGULATORS[order]), lqg.TIME, axis, filtered=False)
    crossover, phase, gain, peak = MARGINS[order][axis]
    assert margins.stable
    assert margins.gain_crossings[-1].frequency / (2 * np.pi) == pytest.approx(crossover, abs=0.02)
    assert margins.phase_margin == pytest.approx(phase, abs=0.1)
    assert margins.gain_margin == pytest.approx(gain, abs=0.01)
    assert margins.peak_sensitivity == pytest.approx(peak, abs=0.01)


def test_poles_of_the_loop_are_the_regulators_and_the_observers() -> None:
    """With the delay predicted they are those of A + B K with a sum for the integral, of the observers, and zeros."""
    T = lqg.TIME.period_s
    for axis in lqg.axes(PLANT):
        A = np.array([[1, T, 0], [0, 1, 0], [1, 0, 1]])
        B = axis.b * np.array([[T**2 / 2], [T], [0]])
        regulated = np.linalg.eigvals(A - B @ [[axis.k1, axis.k2, axis.k3]])
        L = ideal_loops.of_axis(lqg.law(PLANT), lqg.TIME, axis.name, filtered=False)
        poles = np.linalg.eigvals(L.A - L.B @ L.C)
        for pole in (*regulated, lqg.OBSERVER_POLE[axis.name]):
            assert np.abs(poles - pole).min() < tolerances.of("multiple_root"), axis.name
        assert np.abs(regulated).max() < 0.96


@pytest.mark.parametrize("axis", PEAKS)
def test_what_the_observers_pole_costs(monkeypatch: pytest.MonkeyPatch, axis: str) -> None:
    for p, expected in PEAKS[axis].items():
        monkeypatch.setitem(lqg.OBSERVER_POLE, axis, p)
        L = ideal_loops.of_axis(lqg.law(PLANT), lqg.TIME, axis, filtered=False)
        margins = ideal_loops.stability_margins.of_loop(L)
        assert margins.stable and margins.peak_sensitivity == pytest.approx(expected, abs=0.01)
        if p in CURRENTS.get(axis, {}):
            assert NOISE[axis] * demand(axis, p) == pytest.approx(CURRENTS[axis][p], abs=0.005)


def test_a_demand_is_the_current_of_the_motors_that_meet_it() -> None:
    """1 A of x in motor C, 1 A of phi in A and B: what `demand` returns is what the module's text calls a current."""
    d = dict.fromkeys((s.name for s in allocation.DEMANDS), 0.0) | {"phi": 0.0}
    met = agree.casadi(allocation.allocation(PLANT, lqg.TIME))
    of_x, of_phi = (
        met({}, {n: np.array([v]) for n, v in (d | one).items()}).outputs for one in ({"d_x": 1.0}, {"d_phi": 1.0})
    )
    assert (of_x["i_CQ"], of_phi["i_AQ"], of_phi["i_BQ"]) == (
        pytest.approx(1.0),
        pytest.approx(-1.0),
        pytest.approx(1.0),
    )


def demand(axis: str, p: float) -> float:
    """Return the deviation of a demand in A for white noise of deviation 1 in a position."""
    made = next(a for a in lqg.axes(PLANT) if a.name == axis)
    T, b, L = lqg.TIME.period_s, made.b, (1 - p) / lqg.TIME.period_s
    c1, c2 = b * T**2 / 2, b * T
    # q, v, f1, x3, z; n -> f
    rate = np.array([L, 0, 0, 1, 0, L])
    seen = np.array([1, 0, 0, 0, 0, 1.0])
    late = np.array([0, 0, 1.0, 0, 0, 0])
    q1, v1 = seen + T * rate + c1 * late, rate + c2 * late
    f = -made.k1 * q1 - made.k2 * v1 - made.k3 * (seen + np.eye(6)[4])
    rows = np.array(
        [
            [1, T, c1, 0, 0, 0],
            [0, 1, c2, 0, 0, 0],
            f,
            p * np.eye(6)[3] - L * (1 - p) * seen + (b * T - L * c1) * late,
            np.eye(6)[4] + seen,
        ]
    )
    A, B = rows[:, :5], rows[:, 5]
    X, power = np.outer(B, B), A
    for _ in range(20):
        X, power = X + power @ X @ power.T, power @ power
    return float(np.sqrt(f[:5] @ X @ f[:5] + f[5] ** 2))


@pytest.mark.parametrize("p", [0.0, 0.7])
@pytest.mark.parametrize("delay", [0, 1])
def test_behind_the_filter_it_is_unstable(monkeypatch: pytest.MonkeyPatch, p: float, delay: int) -> None:
    """(6)-(16) between positions and (33) leave x no margin at all, whatever p; without the filter x is stable."""
    for axis in allocation.HORIZONTAL:
        monkeypatch.setitem(lqg.OBSERVER_POLE, axis, p)
    behind = [after_filter(b) for b in lqg.law(PLANT)]
    assert not ideal_loops.margins_of(behind, lqg.TIME, "x", filtered=True, delay=delay).stable
    assert ideal_loops.margins_of(lqg.law(PLANT), lqg.TIME, "x", filtered=False, delay=delay).stable


def after_filter(block: Block) -> Block:
    """Return a regulator that reads the filtered position."""
    if not block.name.startswith("lqg_"):
        return block
    raw, axis = block.inputs[0], block.inputs[0].name.removesuffix("_raw")
    symbol = {axis if n == raw.name else n: s for n, s in block.symbol.items()}
    return replace(block, inputs=(replace(raw, name=axis), *block.inputs[1:]), symbol=symbol)


def test_h_of_42_is_refused() -> None:
    """The reduced-order gain on x, y, phi, z1, z2, z3: 1600 is 2/T, which puts the observer's poles to z = -1."""
    H = np.hstack([np.full((3, 3), 0.0006), np.eye(3)])
    H[[0, 1, 2], [0, 1, 2]] = 1600.0
    held = lqg.discretise.zero_order_hold(lqg.model(), lqg.TIME.period_s)
    with pytest.raises(ModelError, match=r"has the poles -1.*does not decay, which needs \|z\| < 1"):
        reduced_observer.from_gain(held, lqg.STATES[:6], H)
    for axis in lqg.axes(PLANT):
        with pytest.raises(ModelError, match="does not decay"):
            lqg.observer(axis, pole=-1.0)


@pytest.mark.parametrize("axis", HEIGHTS)
def test_steps_of_the_stage(known: host.Controller, axis: str) -> None:
    height = HEIGHTS[axis]
    run = ideal_runs.run(known, 0.4, {axis: height})
    assert 0.35 < ideal_runs.overshoot(run[axis], height) < 0.47
    assert ideal_runs.rise(run[axis], height, lqg.TIME.period_s) < 0.014
    assert run[axis][-1] == pytest.approx(height, rel=1e-6)
    assert max(np.abs(run[a]).max() for a in allocation.HORIZONTAL if a != axis) < 1e-9


def unbounded(monkeypatch: pytest.MonkeyPatch) -> list[Block]:
    """Return a law to which an error counts as it is, however large."""
    monkeypatch.setattr(lqg, "ERROR", dict.fromkeys(lqg.ERROR, 1.0))
    return lqg.law(PLANT)


def test_a_step_beyond_the_motors_does_not_wind_up(monkeypatch: pytest.MonkeyPatch) -> None:
    """5 mm in x: it overshoots little more than one within reach, and much less than where a demand passes as made."""
    law = unbounded(monkeypatch)
    deaf = law
    for axis in ("x", "phi"):
        deaf = [
            *loop.cut(deaf, f"achieved_{axis}"),
            *ideal_loops.renaming_blocks(lqg.TIME, {f"achieved_{axis}": f"d_{axis}"}, "A"),
        ]
    assert len(deaf) == len(law) + 2
    runs = [ideal_runs.run(ideal_runs.compile_law(each, lqg.TIME), 0.6, {"x": 5e-3}) for each in (law, deaf)]
    with_anti_windup, without = (ideal_runs.overshoot(run["x"], 5e-3) for run in runs)
    assert np.count_nonzero(random_steps.is_saturated(runs[0].commands)) > 20
    # A motor's 1.13 A along its motion leave 55 %.
    assert (
        with_anti_windup < 0.6
        and not without < 2 * with_anti_windup
        and runs[0]["x"][-1] == pytest.approx(5e-3, rel=1e-6)
    )


# axis: height in m, overshoot
LARGE = {"x": (0.06, 0.01), "y": (0.06, 0.03)}


@pytest.mark.parametrize("axis", LARGE)
def test_large_steps_overshoot_little(known: host.Controller, axis: str) -> None:
    height, beyond = LARGE[axis]
    run = ideal_runs.run(known, 1.5, {axis: height})
    assert ideal_runs.overshoot(run[axis], height) < beyond
    assert run[axis][-1] == pytest.approx(height, rel=1e-6)
    # No faster than where an error that counts as ERROR pushes no more, but for what the motors take to see it.
    made = next(a for a in lqg.axes(PLANT) if a.name == axis)
    limit = (made.k1 + made.k3) * lqg.ERROR[axis] / made.k2
    assert 0.5 * limit < np.abs(np.diff(run[axis])).max() / lqg.TIME.period_s < 1.3 * limit


def test_without_a_bound_of_the_error_a_large_step_loses_the_platen(monkeypatch: pytest.MonkeyPatch) -> None:
    run = ideal_runs.run(ideal_runs.compile_law(unbounded(monkeypatch), lqg.TIME), 0.6, {"x": 0.06})
    assert not np.abs(run["x"]).max() < 0.1


@pytest.mark.parametrize("order", ["reduced", "full"])
def test_it_starts_at_rest_wherever_the_platen_is(order: Order) -> None:
    """Its observer knows no rate before the first good sample; one that took itself for ready would see 5 m/s."""
    controller = ideal_runs.compile_law(lqg.law(PLANT, regulate=REGULATORS[order]), lqg.TIME)
    first = np.r_[0.0, np.ones(159)]
    calm, kicked = (
        ideal_runs.run(controller, 0.2, {"x": 0.02}, start={"x": 0.02}, ready=flags)["x"] for flags in (first, 1.0)
    )
    assert np.abs(calm - 0.02).max() < 1e-9
    assert np.abs(kicked - 0.02).max() > 1e-4


def test_gains_are_those_of_the_reference() -> None:
    for axis in lqg.axes(PLANT):
        other, observer = reference.axes()[axis.name], lqg.observer(axis)
        pairs = ((axis.b, other.b), (axis.k1, other.k_q), (axis.k2, other.k_v), (axis.k3, other.k_z))
        for mine, theirs in (*pairs, (observer.F[0, 0], other.p)):
            assert mine == pytest.approx(theirs, rel=DOUBLE)
