"""A levitator that carries a voice-coil axis, under two PID laws composed by hand."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from designs.levitator_pid import reference

from models import levitator
from synth import stage
from synth.block import Block, Constant, Exprs, State, Step, build
from synth.check import Check
from synth.signals import Signal
from synth.simulate import metrics
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import sample_times
from synth.stage import Actuator, Sensor, SetPoint
from synth.timing import Discrete

PLANT = levitator.plant()
TIME = Discrete(1 / 2000)
INTERFACE = stage.interface(
    PLANT,
    sensors=[Sensor("z", resolution=1e-7), Sensor("x", resolution=1e-7)],
    set_points=[SetPoint("z_ref", of="z", low=-5e-4, high=5e-4), SetPoint("x_ref", of="x", low=-8e-4, high=8e-4)],
    actuators=[Actuator("i1", safe=0.0, slew_per_s=100.0), Actuator("i2", safe=0.0, slew_per_s=100.0)],
    disturbances=["hum"],
    bad_samples=4,
    safe_output_effect="without current the magnets hold the stage at its stop and the flexure centres x",
)
GAINS = {"z": ("i1", 1800.0, 3.4e4, 18.0), "x": ("i2", 1450.0, 3e4, 10.0)}  # A/m, A/m/s, A s/m
VELOCITY_POLE = 0.4  # of the filtered rate, a sample


def pid(axis: str) -> Block:
    """Return u = P e + I + D v with the integral I' = Ki e and the rate v of e behind a filter of one pole."""
    actuator, P, Ki, D = GAINS[axis]
    error, limit = INTERFACE.error(axis), INTERFACE.signals[actuator].high
    width = (error.high - error.low) / TIME.period_s
    demand = INTERFACE.demand(actuator)
    values = {
        "p": P,
        "i": Ki * TIME.period_s,
        "d": D,
        "velocity_pole": VELOCITY_POLE,
        "velocity_gain": (1 - VELOCITY_POLE) / TIME.period_s,
    }
    units = {"p": "A/m", "i": "A/m", "d": "A s/m", "velocity_pole": "1", "velocity_gain": "1/s"}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        e = u[error.name]
        v = k["velocity_pole"] * x["v"] + k["velocity_gain"] * (e - x["e_previous"]) * u["ready"]
        return Step({demand.name: k["p"] * e + x["integral"] + k["d"] * v}, _next(x, k, e, v, u[f"{actuator}_excess"]))

    states = [
        State(Signal("integral", "A", -2 * limit, 2 * limit), 0.0),
        State(Signal("v", "m/s", -width, width), 0.0),
        State(Signal("e_previous", "m", error.low, error.high), 0.0),
    ]
    inputs = [error, Signal("ready", "1", 0, 1), INTERFACE.excess(actuator)]
    constants = [Constant(n, v, units[n], "by hand") for n, v in values.items()]
    return build(
        f"pid_{axis}", TIME, law, inputs=inputs, outputs=[demand], states=states, constants=constants, tag="PID"
    )


def _next(x: Exprs, k: Exprs, e: Exprs, v: Exprs, excess: Exprs) -> Exprs:
    return {"integral": x["integral"] + k["i"] * e + 0.05 * excess, "v": v, "e_previous": e}


@dataclass(frozen=True)
class Settles:
    """A step of a set-point that must settle."""

    name: str
    size: float

    def run(self, rig: Rig) -> Experiment:
        """Run half a second of it."""
        time = sample_times(0.5, rig.period_s)
        reference = np.where(time < 0.05, 0.0, self.size)
        run = rig.run(0.5, {}, {self.name: reference})
        axis = self.name[0]
        settled = metrics.settling_time(time[100:], run[axis][100:] - self.size, 0.05 * self.size)
        check = Check("settles", settled, 0.3, "s")
        return Experiment(f"step_{axis}", f"Step of {axis}", "", run, (axis,), {axis: reference}, {}, (check,))


def variant(parts: Mapping[str, Block]) -> stage.Controller:
    """Return the controller of other laws by axis."""
    return stage.controller("levitator_pid", TIME, INTERFACE, list(parts.values()))


DESIGN = stage.design(
    variant({axis: pid(axis) for axis in GAINS}),
    PLANT,
    reference=reference.step,
    operating_points={"low": {"z": -5e-4}, "mid": {"z": 0.0}, "high": {"z": 5e-4}},
    experiments=[Settles("z_ref", 2e-4), Settles("x_ref", 2e-4)],
    stops=levitator.STOPS,
    velocities=levitator.VELOCITY,
    require={"phase_margin": 25.0, "modulus_margin": 0.4},
    about="Two PID laws composed by hand.",
)
