"""Experiments of the precise design: those of the stage with its limits, and tracking by stages as they are built."""

from dataclasses import replace

from designs.maglev import experiments, motions
from models import maglev_as_built, maglev_stage
from synth.check import Check
from synth.declare.experiments import Run
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig

TRACKING = {"y": 1e-6, "x": 1e-6, "z": 1e-6, "theta": 3e-6}  # m, rad: mean errors from 10 to 60 s
GUIDED = {"y": 2.5e-6, "x": 15e-6, "z": 15e-6, "theta": 3e-6}  # with friction, cogging and errors of the encoders
LIMITS = experiments.Limits(  # those of the paper's design that it reaches or passes
    y=(0.135, 1.83, 3.31),
    xz=(0.21, 1.74, 3.15),
    theta=(0.072, 1.65, 1.93),
    wrong=(0.40, 3.3, 6.0),
    tracking=TRACKING,
)
PLANTS = 16
FRICTION, ENCODER_ERROR = {"x": 1.8, "z": 1.3}, 1e-6  # N, fitted to the paper's ellipse; m


def as_built(rig: Rig, corner: int, guided: bool) -> Rig:
    """Return the rig with the plant at a corner of its tolerances, with friction and encoder errors if `guided`."""
    nominal = maglev_as_built.plant()
    values = maglev_as_built.corner(nominal, corner)
    if not guided:
        return replace(rig, plant=nominal.with_parameters(**values))
    guides = maglev_stage.guide_disturbance(rig.stage.plant, FRICTION, 3)
    plant = nominal.with_parameters(**values, encoder_error=ENCODER_ERROR)
    sensors = tuple(replace(s, of=f"{s.of}_read") for s in rig.stage.interface.sensors)
    return replace(rig, plant=plant, disturbance=guides).with_interface(sensors=sensors)


def _tracking_as_built(rig: Rig, guided: bool) -> Experiment:
    """Run the 4-DOF tracking on all plants; the trajectory is that of the first."""
    runs = [motions.tracking(as_built(rig, k, guided), True) for k in range(PLANTS)]
    errors = [motions.mean_errors(*run) for run in runs]
    limits = GUIDED if guided else TRACKING
    worst = {axis: max(e[axis] for e in errors) for axis in motions.UNITS}
    checks = [Check(f"worst mean |e_{n}|", worst[n], most, motions.UNITS[n]) for n, most in limits.items()]
    figures = {f"worst mean |e_{n}|, u{motions.UNITS[n]}": e * 1e6 for n, e in worst.items()}
    about = f"{PLANTS} plants at corners of their tolerances"
    return experiments.experiment(*runs[0][:1], about, runs[0][1], figures, checks)


ALL: tuple[Run, ...] = (
    *experiments.of(LIMITS),
    experiments.run("as_built", "4-DOF tracking, plants as built", _tracking_as_built, guided=False),
    experiments.run("as_built_guided", "4-DOF tracking, plants with guides", _tracking_as_built, guided=True),
)
