"""A stage that a permanent magnet and a coil levitate in z, with a voice coil that moves it in x, at 2 kHz.

The magnet carries most of the weight and pulls the more, the nearer the stage is: z is unstable without control. Both
axes follow a sine of 10 Hz without an error, and x cancels the force of the mains at 50 Hz.
"""

from collections.abc import Mapping
from math import pi
from pathlib import Path

from designs.levitator_2dof import reference
from models import levitator
from synth import stage
from synth.analyse import operating_points
from synth.blocks.laws import axis
from synth.declare.experiments import Conditions, Hold, LiftOff, Sine, StepResponse, Track
from synth.declare.tuning import Bench, FreeParameter, Tuning
from synth.stage import Actuator, FaultCampaign, FaultLimit, Sensor, SetPoint, StudyLimits
from synth.synthesise.nonlinear import feedback_linearisation
from synth.timing import Discrete

TIME = Discrete(1 / 2000)  # s
SCAN, MAINS = 2 * pi * 10, 2 * pi * 50  # rad/s: of the set-points, and of the disturbance
PLANT = levitator.plant()
REST = operating_points.trim(PLANT, {"z": 0.0}, ["i1", "i2"])
INVERSE = feedback_linearisation.of_plant(PLANT, ["z"], {"i2": 0.0, "hum": 0.0})

INTERFACE = stage.interface(  # units, and ranges that are left out, come from the plant; sensors reach beyond the stops
    PLANT,
    sensors=[
        Sensor("z", low=-7e-4, high=7e-4, resolution=1e-7, offset=1e-6, gain_error=1e-3),  # m
        Sensor("x", low=-1.1e-3, high=1.1e-3, resolution=1e-7, offset=1e-6, gain_error=1e-3),
    ],
    set_points=[SetPoint("z_ref", of="z", low=-5e-4, high=5e-4), SetPoint("x_ref", of="x", low=-8e-4, high=8e-4)],
    actuators=[Actuator("i1", safe=0.0, slew_per_s=100.0), Actuator("i2", safe=0.0, slew_per_s=100.0)],  # A, A/s
    disturbances=["hum"],
    delay=1,  # sample from measurement to actuation: in synthesis, margins and simulation alike
    bad_samples=4,  # in a row, then the safe output
    safe_output_effect="without current the stage comes down to its stop and the flexure centres x",
)
FREE = [  # what `synth tune` may change: initial value, least and largest value
    FreeParameter("damping_z", 1e3, 1e2, 1e5, "s^2/m^2", "weight of vz"),
    FreeParameter("set_point_weight_z", 0.6, 0.0, 1.0, "1", "weight of the set-point"),
    FreeParameter("damping_x", 1e2, 1e1, 1e5, "s^2/m^2", "weight of vx"),
    FreeParameter("set_point_weight_x", 0.5, 0.0, 1.0, "1", "weight of the set-point"),
]
HEAVY, STIFF = (Conditions(parameters=p) for p in (levitator.HEAVY, levitator.STIFF))
HUMMING = Conditions(disturbances={"hum": Sine(0.2, MAINS)})  # N
ON_ITS_STOP = Conditions(start={"z": levitator.STOPS["z"][0]})


def axes(p: Mapping[str, float]) -> tuple[axis.ServoLaw, axis.ServoLaw]:
    """Return the laws of z and x: LQG servos with internal models, for values of the free parameters."""
    z = axis.servo(
        INVERSE.chain("z"),
        modes={0.0: 25.0, SCAN: 20.0},  # {frequency in rad/s: rate in 1/s at which its error decays}
        weights={"z": 1e8, "vz": p["damping_z"]},
        command_weight=1e-2,
        estimator=axis.kalman(process={"vz": 3e-5}, sensor={"z": 1e-14}),  # m^2/s^3, m^2
        anti_windup=30.0,  # 1/s
        set_point_weight=p["set_point_weight_z"],
    )
    x = axis.servo(
        operating_points.linearise(PLANT, REST).channel("x", "i2"),
        modes={0.0: 25.0, SCAN: 20.0, MAINS: 20.0},
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
    tolerances=["M", "K"],  # the margins hold at all their limits, too
    require={  # degrees and s; a little below the least of all loops, points and limits of the tolerances
        "phase_margin": 38.0,
        "gain_margin": 2.4,
        "gain_reduction": 4.1,
        "delay_margin": 1.35e-3,
        "modulus_margin": 0.51,
        "disk_margin": 0.32,
    },
    experiments=[
        StepResponse("z_ref", 3e-4, overshoot=0.05, settling_time_s=0.2),  # m; of the step; to within 2 %
        StepResponse("x_ref", 5e-4, overshoot=0.05, settling_time_s=0.2),
        StepResponse("z_ref", 3e-4, overshoot=0.1, settling_time_s=0.2, conditions=HEAVY, label="heavy"),
        StepResponse("x_ref", 5e-4, overshoot=0.1, settling_time_s=0.2, conditions=STIFF, label="stiff"),
        Track({"z_ref": Sine(3e-4, SCAN), "x_ref": Sine(5e-4, SCAN, pi / 2)}, mean_error=2e-7),
        Hold({"z_ref": 2e-7, "x_ref": 5e-7}, duration_s=2.0, after_s=1.5, conditions=HUMMING),  # largest errors, m
        LiftOff({"z_ref": 0.0}, ramp_s=0.2, overshoot=0.05, error=2e-7, conditions=ON_ITS_STOP),
    ],
    study=StudyLimits(0.95, dict.fromkeys(["track*: mean *", "hold*: largest *", "lift_off: |e_z| *"], 2e-6)),  # m
    stops=levitator.STOPS,
    faults=FaultCampaign(
        inertias={"z": "M", "x": "m"},
        limits=[
            FaultLimit("false_alarms", 0.0),
            FaultLimit("healthy_impact", 0.0),  # m/s
            FaultLimit("latch_s", 2e-3, kind="not finite", duration="permanent"),
            FaultLimit("impact", 0.05, kind="not finite"),  # m/s
            FaultLimit("excursion_z", 2e-6, kind="not finite", duration="short"),  # m
        ],
    ),
    safe_output=stage.read_safe_output(Path(__file__).with_name("safe_output.json")),
    most_instructions=600,  # of a sample on a Cortex-M4F
    tuning=Tuning(FREE, controller, require={"disk_margin": 0.4}, bench=Bench({"damping_z": (6e2, 1.6e3)})),
    about=__doc__,
)
