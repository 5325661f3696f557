"""The planar positioner's experiments keep their limits, what they measure is right, and planted defects are seen."""

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest

from designs.planar_6dof import allocation, failures, interface, loads, lqg, voltages
from designs.planar_6dof import loop as loops
from designs.planar_6dof.loop import simulate
from designs.planar_6dof.paper import rows as paper
from designs.planar_6dof.sensing import calibration, sections
from designs.planar_6dof_leadlag import control as leadlag
from designs.planar_6dof_leadlag import experiments as leadlag_experiments
from designs.planar_6dof_lqg import experiments as lqg_experiments
from models import halbach, planar_stage
from synth.blocks.faults import innovation_monitor
from synth.fault import BRAKING_BIT, LATCH_BIT
from synth.simulate import experiments
from synth.simulate.experiments import Experiment
from synth.simulate.faults import sensor_faults
from synth.simulate.faults.sensor_faults import Response
from synth.simulate.rig import Rig
from synth.simulate.scenario import sample_times

pytestmark = pytest.mark.whole

PLANT = planar_stage.plant()
ACTUATORS = [s.name for s in interface.OUTPUTS]
VALUES = {p.name: ca.SX(p.value) for p in PLANT.parameters}
Runs = dict[str, dict[str, Experiment]]
STEPS = ("step_x", "step_y", "step_phi")
RESTS = ("standstill", "standstill_printed_noise", "standstill_6.525_V", "standstill_24_V")
FAILURES = [f"{kind}_{where}" for where in ("resting", "moving") for kind in ("nan", "zero", "stuck")]
FAILURES += ["zero_anywhere", "stuck_anywhere"]
LOADS = [
    f"withstands_{what}" for what in ["force_x", "force_y", "cables", "waves", "noise", "floor", "currents", "all"]
]


@pytest.fixture(scope="module")
def lead() -> Rig:
    return loops.of(leadlag.controller(PLANT))


@pytest.fixture(scope="module")
def optimal() -> Rig:
    return loops.of(lqg.controller(PLANT))


@pytest.fixture(scope="module")
def all_runs(lead: Rig, optimal: Rig) -> Runs:
    """Return every experiment but those over the finite matrix, which `test_finite` runs."""
    runs = {"leadlag": (leadlag_experiments.ALL, lead), "lqg": (lqg_experiments.ALL, optimal)}
    return {
        name: {e.name: experiments.result(e, loop) for e in every if not e.name.endswith("_finite")}
        for name, (every, loop) in runs.items()
    }


def test_every_experiment_keeps_its_limits(all_runs: Runs) -> None:
    checks = [(n, e.name, c) for n, run in all_runs.items() for e in run.values() for c in e.checks]
    assert not [f"{n} {e}: {c.name} {c.value:.4g} > {c.limit:.4g} {c.unit}" for n, e, c in checks if not c.passed]
    assert len(checks) >= 80
    assert set(all_runs["leadlag"]) == {*STEPS, "circle", *RESTS, *FAILURES, *LOADS}
    assert set(all_runs["lqg"]) == {*STEPS, "step_x_large", *RESTS, *FAILURES, *LOADS}


def test_steps_of_the_lead_lag_controller(all_runs: Runs) -> None:
    """With the Kalman filter and a sample of delay; `test_control` finds the same with the positions known."""
    for axis, rise, beyond in (("x", 19.2, 23.8), ("y", 19.1, 23.8), ("phi", 10.4, 17.4)):
        e = all_runs["leadlag"][f"step_{axis}"]
        assert 1e3 * e.figures["rise, s"] == pytest.approx(rise, abs=0.3)
        assert 100 * e.figures["overshoot"] == pytest.approx(beyond, abs=1)
        assert abs(e.figures["true error at the end, without noise, of the step"]) < 0.01


def test_noise_at_rest(all_runs: Runs) -> None:
    """As runs of 400 s have it, within 3 sd of a short one; what is raw follows what is planted."""
    for name, filtered, true in (("leadlag", (6.9, 6.9), (4.15, 4.15)), ("lqg", (6.38, 9.05), (9.13, 9.12))):
        e = all_runs[name]["standstill"]
        for axis, seen, moved in zip("xy", filtered, true, strict=True):
            assert e.figures[f"filtered {axis}, um rms"] == pytest.approx(seen, rel=0.1)
            assert e.figures[f"true {axis}, um rms"] == pytest.approx(moved, rel=0.1)
    for run in all_runs.values():
        for name, factor in (("standstill", 13), ("standstill_printed_noise", 50)):
            assert 0.9 * factor < run[name].figures["raw x, um rms"] < 2 * factor


def test_the_stated_voltage_is_too_little_for_the_noise_of_the_lqg_controller(all_runs: Runs) -> None:
    """The lead-lag controller does with it: its noise is that with ideal amplifiers, but for the length of a record."""
    for name, low, high in (("leadlag", 0.85, 1.15), ("lqg", 3.0, 7.0)):
        ideal, short = (all_runs[name][n].figures for n in ("standstill", "standstill_6.525_V"))
        for axis in ("y, um", "phi, urad"):
            assert low < short[f"true {axis} rms"] / ideal[f"true {axis} rms"] < high


def test_the_circle_crosses_pitches_and_no_border_shows(all_runs: Runs) -> None:
    e = all_runs["leadlag"]["circle"]
    for axis in "xy":
        assert e.figures[f"pitches crossed, {axis}"] > 3.9
        assert e.figures[f"switching samples, {axis}"] > 30


def test_recorded_rows(lead: Rig, optimal: Rig) -> None:
    every = [*paper.leadlag(lead), *paper.lqg(optimal)]
    assert len(every) == len({r.id for r in every}) == 42
    rows = {r.id: r for r in every if r.id in ("Y-34", "Y-35", "Y-40", "Y-41")}
    verdicts = {name: str(r.verdict) for name, r in rows.items()}
    assert verdicts == {"Y-34": "R", "Y-35": "N", "Y-40": "N", "Y-41": "R"}
    assert rows["Y-34"]["rms, x"] == pytest.approx(6.9, rel=0.025) == rows["Y-34"]["rms, y"]
    assert rows["Y-35"]["last time outside its band, x"] > 220


# What is measured


def test_noise_is_that_of_a_position(lead: Rig) -> None:
    drawn = lead.sensor_noise(20000)
    assert np.std(drawn["V_ax"]) == pytest.approx(13e-6 * calibration.of(lead.plant).volts_per_metre, rel=0.02)
    assert np.std(drawn["d1"]) == pytest.approx(interface.LASER_NOISE, rel=0.02)
    assert abs(np.corrcoef(drawn["V_ax"], drawn["V_cy"])[0, 1]) < 0.03
    quarter = lead.plant.parameter("l").value / 4
    at = {x: float(lead.run(0.002, {"x": x}).outputs["V_ax"][0]) for x in (-1e-5, 1e-5, quarter)}
    parts = [float(halbach.amplitude(n, ca.SX(3e-3), VALUES)) for n in halbach.HARMONICS]
    slope = calibration.of(lead.plant).volts_per_metre
    assert at[quarter] * parts[0] / sum(parts) == pytest.approx(slope * quarter / (np.pi / 2))
    flatter = np.dot(halbach.HARMONICS, parts) / parts[0]
    assert (at[1e-5] - at[-1e-5]) / 2e-5 == pytest.approx(flatter * slope, rel=1e-4)
    assert 1 - flatter == pytest.approx(0.22, abs=0.005)


def test_one_seed_is_one_run(lead: Rig) -> None:
    first, again, other = (replace(lead, seed=s).run(0.05, {}, {}).measured["V_bx"] for s in (0, 0, 1))
    np.testing.assert_array_equal(first, again)
    assert (first != other).any()
    counts = first / interface.ADC
    np.testing.assert_allclose(counts, np.rint(counts), atol=0.01)  # single precision of a count


def test_substeps_are_fine_enough(lead: Rig) -> None:
    """Four times as many change the position by less than a thousandth of its noise."""
    few, many = (
        simulate(lead, 0.3, {"x": 1e-4, "psi": 1e-4}, {}, substeps=n)
        for n in (interface.SUBSTEPS, 4 * interface.SUBSTEPS)
    )
    np.testing.assert_allclose(few["x"], many["x"], atol=1e-3 * interface.NOISE)


def test_voltages_are_those_of_resistance_inductance_and_motion(lead: Rig) -> None:
    """At v along x, motor C alone has a voltage of amplitude 2 K v / 3; without motion, R i and L di/dt."""
    plant, v, T = planar_stage.plant(), 0.1, lead.period_s
    idle = dict.fromkeys(ACTUATORS, 0.0)
    run = replace(lead, plant=plant).ideal.run(0.6, {"vx": v}, actuators={}, forcing=idle)
    u = voltages.phase_voltages(plant, run)
    assert np.abs(u[6:]).max() == pytest.approx(2 / 3 * allocation.force_constant(plant) * v, rel=1e-3)
    assert np.abs(u[:6]).max() < 1e-9
    R, L = (plant.parameter(n).value for n in ("resistance", "inductance"))
    still = replace(lead, plant=plant).ideal.run(0.002, {}, {}, actuators={}, forcing=idle | {"i_AA": 0.01})
    u = voltages.phase_voltages(plant, still)
    assert u[0, 0] == pytest.approx(0.01 * (R + L / T)) and u[0, 1] == pytest.approx(0.01 * R, rel=0.03)


def test_an_amplifier_without_limit_follows_and_one_with_a_limit_slews(lead: Rig) -> None:
    """From 0 to 0.2 A: 1 - exp(-t/LAG) without a limit, and (1 - exp(-t R/L)) u/R as long as u is the limit."""
    idle = dict.fromkeys(ACTUATORS, 0.0) | {"i_CA": 0.2}
    R, L = (PLANT.parameter(n).value for n in ("resistance", "inductance"))
    for volts in (1e3, 0.5):
        bad = replace(lead, plant=voltages.plant_with_amplifiers(volts)).ideal
        run = bad.run(0.003, {}, {}, actuators={}, forcing=idle, substeps=64)
        t = run.time
        expected = 0.2 * (1 - np.exp(-t / voltages.LAG)) if volts > 1 else 0.5 / R * (1 - np.exp(-t * R / L))
        np.testing.assert_allclose(run["true_i_CA"], expected, rtol=0.01)  # the platen gives way


def fail(loop: Rig, channel: str, kind: str, speed: failures.Place = failures.REST) -> Response:
    (response,) = sensor_faults.responses(failures.failures(kind, speed, sensors=[channel]), loop)
    return response


def caught(f: Response, kind: str) -> set[str]:
    return {c.name for c in sensor_faults.checks(failures.failures(kind), [f]) if not c.passed}


def test_a_failed_channel_is_the_one_that_is_named(lead: Rig) -> None:
    for f in sensor_faults.responses(failures.failures("nan"), lead):
        assert f.detection == 0 and f.latch == 4 + interface.BRAKING and not f.others and f.contradicted == np.inf
    for f in sensor_faults.responses(failures.failures("stuck"), lead):  # at rest, where no motion shows it
        assert not f.others and f.detection <= innovation_monitor.longest(len(failures.HALL), sections.REPEATS) + 2


def test_noise_is_no_failure(lead: Rig, optimal: Rig) -> None:
    """A minute of what section 3.2 says, at rest and along the circle; three times as much does look like failures."""
    for loop, factor, alarm in ((lead, 1, False), (optimal, 1, False), (lead, 3, True), (optimal, 3, True)):
        noisy = loops.with_noise(loop, factor * interface.NOISE_PRINTED)
        time = sample_times(60.0, loop.period_s)
        part = leadlag_experiments.RADIUS * np.clip(time / leadlag_experiments.GROWTH, 0, 1) ** 2
        turn = leadlag_experiments.RATE * time
        for references in ({}, {"x": part * np.cos(turn), "y": part * np.sin(turn)}):
            run = simulate(noisy, 60.0, references, {})
            largest = failures.residuals(noisy, run)[1:].max()
            assert run.faults.any() == alarm and largest > 0.4
            assert alarm or largest < 1


# Planted defects


ISOLATION = "samples from a residual out of bounds to the"


def test_late_braking_and_a_late_latch_after_it_are_caught(optimal: Rig) -> None:
    """The planted defects: a failure that is counted from a sample earlier, one that never brakes or never latches."""
    f, zero = (fail(optimal, "V_cx", kind, failures.SPEED) for kind in ("nan", "zero"))
    braking, latch = f"{ISOLATION} channel's name, braking or the latch", f"{ISOLATION} latch"

    def without(f: Response, *bits: int) -> Response:
        faults = f.run.faults & np.uint32(0xFFFFFFFF - sum(1 << b for b in bits))
        return replace(f, run=replace(f.run, faults=faults))

    assert f.brakes == 4 and f.latch == 4 + interface.BRAKING == 4 + f.interface.braking
    assert not caught(f, "nan") and not caught(zero, "zero") and zero.contradicted < np.inf
    early = replace(f, sample=f.sample - 1)
    assert caught(early, "nan") == {"samples until it brakes", "samples until the latch"}
    hasty = replace(f, interface=replace(f.interface, braking=f.interface.braking - 1))
    assert caught(hasty, "nan") == {"samples until the latch"}
    assert caught(without(f, BRAKING_BIT), "nan") == {"samples until it brakes"}
    assert caught(without(zero, LATCH_BIT), "zero") >= {latch, "channels whose failure is not noticed"}
    named = [b for b in range(BRAKING_BIT) if zero.bits["V_cx"] >> b & 1]
    assert caught(without(zero, BRAKING_BIT, *named), "zero") >= {braking}


def test_waves_of_the_field_are_a_share_of_the_fundamental_in_the_voltages() -> None:
    wavy, pose = loads.with_waves(PLANT, 1.0), [0.013, 0.007, *np.zeros(10)]
    x = [*pose[:2], *np.zeros(len(PLANT.states) - 2)]
    u = np.zeros(len(PLANT.inputs))
    plain, seen = (np.asarray(p.h(x, u, p.values)).ravel() for p in (PLANT, wavy))
    w = 2 * np.pi / PLANT.parameter("l").value
    number = [o.name for o in PLANT.outputs].index("V_ax")
    fundamental = calibration.of(PLANT).volts_per_metre / w
    expected = 0.02 * fundamental * (np.sin(3 * w * 0.013) + np.sin(5 * w * 0.013))
    assert seen[number] - plain[number] == pytest.approx(expected, rel=1e-3)
    np.testing.assert_array_equal(np.asarray(wavy.f(x, u, wavy.values)), np.asarray(PLANT.f(x, u, PLANT.values)))
