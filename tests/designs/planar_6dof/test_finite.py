"""The loops over a finite magnet matrix keep their bars; what they must not bear is seen."""

from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import finite, interface, lqg
from designs.planar_6dof import loop as loops
from designs.planar_6dof_leadlag import control as leadlag
from designs.planar_6dof_leadlag import experiments as leadlag_experiments
from designs.planar_6dof_lqg import experiments as lqg_experiments
from models import finite_stage, planar_stage
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig

pytestmark = pytest.mark.whole

PLANT = planar_stage.plant()
Runs = dict[str, dict[str, Experiment]]
NAMES = {"step_x_finite", "step_y_finite", "step_phi_finite", "standstill_finite"}


@pytest.fixture(scope="module")
def lead() -> Rig:
    return loops.of(leadlag.controller(PLANT))


@pytest.fixture(scope="module")
def all_runs(lead: Rig) -> Runs:
    """Return every experiment, but of the circle a small piece: `test_the_circle` has all of it."""
    with pytest.MonkeyPatch.context() as patch:
        for name, short in (("RADIUS", 0.02), ("GROWTH", 3.0), ("REVOLUTION", 1.0)):
            patch.setattr(leadlag_experiments, name, short)
        first = {e.name: e.run(lead) for e in leadlag_experiments.ALL if e.name.endswith("_finite")}
    optimal = loops.of(lqg.controller(PLANT))
    return {
        "leadlag": first,
        "lqg": {e.name: e.run(optimal) for e in lqg_experiments.ALL if e.name.endswith("_finite")},
    }


def failing_checks(e: Experiment) -> set[str]:
    return {c.name for c in e.checks if not c.passed}


def test_every_experiment_keeps_its_bars(all_runs: Runs) -> None:
    checks = [(n, e.name, c) for n, run in all_runs.items() for e in run.values() for c in e.checks]
    assert not [f"{n} {e}: {c.name} {c.value:.4g} > {c.limit:.4g} {c.unit}" for n, e, c in checks if not c.passed]
    assert len(checks) >= 75
    assert set(all_runs["leadlag"]) == NAMES | {"circle_finite"} and set(all_runs["lqg"]) == NAMES


def test_steps_are_those_on_the_closed_law_but_for_a_few_per_cent(all_runs: Runs) -> None:
    """The loops' gain is 7 % higher. x and y end where sensors over these blocks show them: off by up to 19 % of it.

    phi ends 0.6 % off, and 0.1 % without the estimate of the amplitude, to which the end of the matrix contributes.
    """
    for name, run in all_runs.items():
        for axis, departs, off in (("x", 0.01, 0.2), ("y", 0.01, 0.2), ("phi", 0.07, 0.007)):
            figures = run[f"step_{axis}_finite"].figures
            assert 0.003 < figures["response departs from the closed law's by, of the step"] < departs, (name, axis)
            assert abs(figures["true error at the end, without noise, of the step"]) < off
    moves = all_runs["lqg"]["step_phi_finite"].figures
    assert moves["psi moves from the step on, without noise, urad"] == pytest.approx(1493, rel=0.02)
    assert moves["psi does so on the closed law, urad"] < 2


def test_psi_is_what_gets_noisier(all_runs: Runs) -> None:
    """Motors A and B push psi by their end turns: 60 times the noise on the closed law. x and y: 8 %."""
    for name, noise in (("leadlag", 55.6), ("lqg", 175.7)):
        figures = all_runs[name]["standstill_finite"].figures
        assert figures["true psi, urad rms"] == pytest.approx(noise, rel=0.05)
        assert figures["true psi, urad rms"] > 50 * figures["true psi on the closed law, urad rms"]
        assert figures["true x, um rms"] / figures["true x on the closed law, um rms"] == pytest.approx(1.085, abs=0.02)
        assert figures["x wanders without noise by, um"] < 1e-2  # of the dither of ideal sensors
        assert figures["x settles without noise at, um"] == pytest.approx(2.145, abs=0.01)


def test_the_circle(lead: Rig) -> None:
    """All of it, without noise: the sensors stray 0.1 mm rms over these blocks, the control 6.6 um."""
    there = finite.with_finite_matrix(lead)
    twins = {
        finite.CLOSED: leadlag_experiments.circle(lead.ideal),
        finite.AS_BUILT: leadlag_experiments.circle(there.ideal),
    }
    run = twins[finite.AS_BUILT].run
    e = finite.motion_experiment(there, Experiment("circle", "", "", run, ("x", "y")), twins)
    assert len(e.checks) == 5 and not failing_checks(e) and not run.faults.any()
    for axis in "xy":
        assert e.figures[f"error of {axis} as shown (blocks as made), um rms"] == pytest.approx(6.6, abs=0.2)
        assert e.figures[f"error of {axis} as shown (closed law), um rms"] == pytest.approx(4.3, abs=0.2)
        assert e.figures[f"error of {axis} truly (blocks as made), um rms"] == pytest.approx(105, abs=2)
        assert e.figures[f"error of {axis} truly (closed law), um rms"] == pytest.approx(5.1, abs=0.2)
    assert np.abs(run["phi"]).max() == pytest.approx(0.0134, abs=5e-4)
    displaced = replace(
        twins[finite.AS_BUILT], references={a: r + 1.3e-3 for a, r in twins[finite.AS_BUILT].references.items()}
    )
    assert failing_checks(finite.motion_experiment(there, e, {finite.AS_BUILT: displaced})) == {
        *(f"error of {a} as shown" for a in "xy"),
        *(f"greatest true error of {a}" for a in "xy"),
    }


def test_what_departs_from_the_closed_law() -> None:
    forces = finite.motor_deviations(leadlag_experiments.RADIUS)
    for name, mean, least, most in (("ideal blocks", 1.0, 0.824, 1.015), ("blocks as made", 1.0733, 0.886, 1.090)):
        assert forces[f"driving force over K ({name})"] == pytest.approx(mean, abs=5e-4)
        assert forces[f"lifting force over K ({name})"] == pytest.approx(mean, abs=5e-4)
        assert forces[f"least driving force over K on the way ({name})"] == pytest.approx(least, abs=2e-3)
        assert forces[f"greatest driving force over K on the way ({name})"] == pytest.approx(most, abs=2e-3)
        assert forces[f"peak ripple of the driving force ({name})"] == pytest.approx(0.0053, abs=2e-4)
        assert forces[f"peak force across the motion over K ({name})"] < 3e-4
        assert forces[f"peak torque along the conductors ({name}), N m/A"] == pytest.approx(0.098, abs=0.005)
        assert forces[f"peak torque along the motion ({name}), N m/A"] == pytest.approx(0.082, abs=0.005)


# Planted defects


def test_end_turns_in_the_plane_of_the_bands_lose_the_stage(lead: Rig, monkeypatch: pytest.MonkeyPatch) -> None:
    """They twist it by more than the arms of the motors make: psi is lost, and with it the air gap and the fields."""
    monkeypatch.setattr(leadlag_experiments, "RADIUS", 0.05)
    monkeypatch.setattr(leadlag_experiments, "REVOLUTION", 0.1)
    flat = replace(lead, plant=finite_stage.plant(made=False, end_turns=1.0))
    assert leadlag_experiments.circle(flat.ideal).run.faults.any()
    assert not leadlag_experiments.circle(finite.with_finite_matrix(lead, as_built=False).ideal).run.faults.any()


def test_the_noise_is_the_same_on_both_plants(lead: Rig) -> None:
    first, second = (each.run(0.002, {}, {}) for each in (lead, finite.with_finite_matrix(lead)))
    for name in interface.SENSORS:
        assert abs(float(first.measured[name][0] - second.measured[name][0])) < 0.02
