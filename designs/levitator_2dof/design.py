"""A PM-biased levitator that carries a voice-coil axis under the hum of the mains, at 2 kHz."""

from collections.abc import Mapping
from math import pi

from designs.levitator_2dof import reference

from models import levitator
from synth import stage
from synth.analyse import linearisation, operating_points
from synth.blocks import axis
from synth.simulate.conditions import Conditions, Sine
from synth.simulate.experiments import Hold, LiftOff, StepResponse, Track
from synth.stage import Actuator, Sensor, SetPoint
from synth.synthesise.nonlinear import feedback_linearisation
from synth.timing import Discrete
from synth.tuning import FreeParameter, Tuning

TIME = Discrete(1 / 2000)
HUM, COURSE = 100 * pi, 20 * pi  # rad/s: of the mains, and of the course that is to be tracked
PLANT = levitator.plant()
REST = operating_points.trim(PLANT, {"z": 0.0}, ["i1", "i2"])
INVERSE = feedback_linearisation.of_plant(PLANT, ["z"], {"i2": 0.0, "hum": 0.0})

INTERFACE = stage.interface(
    PLANT,
    sensors=[Sensor("z", resolution=1e-7), Sensor("x", resolution=1e-7)],
    set_points=[SetPoint("z_ref", of="z", low=-5e-4, high=5e-4), SetPoint("x_ref", of="x", low=-8e-4, high=8e-4)],
    actuators=[Actuator("i1", safe=0.0, slew_per_s=100.0), Actuator("i2", safe=0.0, slew_per_s=100.0)],
    disturbances=["hum"],
    bad_samples=4,
    safe_output_effect="without current the stage comes down to its stop and the flexure centres x",
)
FREE = [
    FreeParameter("damping_z", 1e3, 1e2, 1e5, "s^2/m^2", "weight of vz"),
    FreeParameter("set_point_weight_z", 0.6, 0.0, 1.0, "1", "weight of the set-point"),
    FreeParameter("damping_x", 1e2, 1e1, 1e5, "s^2/m^2", "weight of vx"),
    FreeParameter("set_point_weight_x", 0.5, 0.0, 1.0, "1", "weight of the set-point"),
]


def axes(p: Mapping[str, float]) -> tuple[axis.ServoLaw, axis.ServoLaw]:
    """Return the laws of z and x for values of the free parameters."""
    z = axis.servo(
        INVERSE.chain("z"),
        modes={0.0: 25.0, COURSE: 20.0},  # rad/s: 1/s
        weights={"z": 1e8, "vz": p["damping_z"]},
        command_weight=1e-2,
        estimator=axis.kalman(process={"vz": 3e-5}, sensor={"z": 1e-14}),  # m^2/s^3, m^2
        anti_windup=30.0,  # 1/s
        set_point_weight=p["set_point_weight_z"],
    )
    x = axis.servo(
        linearisation.linearise(PLANT, REST).channel("x", "i2"),
        modes={0.0: 25.0, COURSE: 20.0, HUM: 20.0},
        weights={"x": 1e8, "vx": p["damping_x"]},
        command_weight=1e1,
        estimator=axis.kalman(process={"vx": 1e-4}, sensor={"x": 1e-14}),
        anti_windup=30.0,
        set_point_weight=p["set_point_weight_x"],
    )
    return z, x


def controller(p: Mapping[str, float]) -> stage.Controller:
    """Return the controller for values of the free parameters."""
    return stage.controller("levitator_2dof", TIME, INTERFACE, axes(p))


DESIGN = stage.design(
    controller({f.name: f.value for f in FREE}),
    PLANT,
    reference=reference.step,
    operating_points={"low": {"z": -5e-4}, "mid": {"z": 0.0}, "high": {"z": 5e-4}, "side": {"x": 8e-4}},
    require={"phase_margin": 30.0, "modulus_margin": 0.5},
    tolerances=["M", "K"],
    experiments=[
        StepResponse("z_ref", 3e-4, overshoot=0.05, settling_time_s=0.2),
        StepResponse("x_ref", 5e-4, overshoot=0.05, settling_time_s=0.2),
        StepResponse("z_ref", 3e-4, 0.1, 0.2, conditions=Conditions(parameters=levitator.HEAVY), label="heavy"),
        StepResponse("x_ref", 5e-4, 0.1, 0.2, conditions=Conditions(parameters=levitator.STIFF), label="stiff"),
        Track({"z_ref": Sine(3e-4, COURSE), "x_ref": Sine(5e-4, COURSE, pi / 2)}, mean_error=2e-7),
        Hold({"z_ref": 2e-7, "x_ref": 5e-7}, 2.0, 1.5, Conditions(disturbances={"hum": Sine(0.2, HUM)})),  # N
        LiftOff({"z_ref": 0.0}, ramp_s=0.2, overshoot=0.05, error=2e-7, conditions=Conditions(start={"z": -6e-4})),
    ],
    stops=levitator.STOPS,
    velocities=levitator.VELOCITY,
    tuning=Tuning(FREE, controller, require={"disk_margin": 0.4}),
    about=__doc__,
)
