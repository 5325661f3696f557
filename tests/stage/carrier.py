"""A mass m with a payload, lifted by k i: its law knows the payload by an auxiliary input and gives

    k i = (m + load) (g + P e + D (v_ff - dz/dt))

so that it rests, with a load that is not the payload, at e = (payload - load) g / ((m + load) P).
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from synth import plant as plants
from synth import stage
from synth.block import Block, Exprs, State, Step, build
from synth.declare.stage import Stage
from synth.plant import Plant
from synth.reference import guard
from synth.signals import Parameter, Signal
from synth.stage import Actuator, Auxiliary, Sensor, SetPoint
from synth.timing import Discrete

M, K, G, P, D, T = 2.0, 10.0, 9.81, 4e3, 140.0, 1e-3
PLANT = plants.build(
    "carrier",
    [Signal("z", "m", -1e-3, 1e-3), Signal("v", "m/s", -0.5, 0.5)],
    [Signal("i", "A", 0.0, 8.0)],
    [Signal("z", "m", -1e-3, 1e-3)],
    [Parameter("m", M, "kg", 0.05, "weighed"), Parameter("payload", 0.0, "kg", (0.0, 1.0), "of the user")],
    lambda x, u, p: ({"z": x["v"], "v": K * u["i"] / (p["m"] + p["payload"]) - G}, {"z": x["z"]}),
)
CASES = {"loaded": {"payload": 1.0, "load": 1.0}, "unannounced": {"payload": 0.2}}
LIMITS = {"z": (-1e-3, 1e-3), "z_ref": (-5e-4, 5e-4), "load": (0.0, 1.0), "v_ff": (-0.1, 0.1)}


def law(interface: stage.Interface) -> Block:
    held = [interface.held(name) for name in LIMITS]

    def step(u: Exprs, x: Exprs, k: Exprs) -> Step:
        velocity = (u["z_held"] - x["before"]) / T
        acceleration = G + P * (u["z_ref_held"] - u["z_held"]) + D * (u["v_ff_held"] - velocity)
        return Step({"i_demand": (M + u["load_held"]) * acceleration / K}, {"before": u["z_held"]})

    before = State(Signal("before", "m", -1e-3, 1e-3), 0.0)
    demand = Signal("i_demand", "A", -60.0, 60.0)
    return build("lift", Discrete(T), step, inputs=held, states=[before], outputs=[demand], tag="lift")


def reference(state: Any, inputs: Any) -> Any:
    values, after, word = guard.standard(state, inputs, LIMITS, "z", 5)
    acceleration = (
        G + P * (values["z_ref"] - values["z"]) + D * (values["v_ff"] - (values["z"] - state["lift_before"]) / T)
    )
    i = np.clip((M + values["load"]) * acceleration / K, 0.0, 8.0)
    latched = after["guard_latched"] > 0
    out, last = guard.slew(state, {"i": i}, latched, 100.0 * T)
    return after | guard.frozen(state, {"lift_before": values["z"]}, latched) | last, out, word


SENSORS = (Sensor("z", offset=2e-6),)


def carrier(of: str = "", plant: Plant = PLANT, sensors: Sequence[Sensor] = SENSORS, **changed: Any) -> Stage:
    interface = stage.interface(
        plant,
        sensors=sensors,
        set_points=[SetPoint("z_ref", of="z", low=-5e-4, high=5e-4)],
        auxiliaries=[
            Auxiliary("load", "kg", 0.0, 1.0, about="on the carrier", of=of),
            Auxiliary("v_ff", "m/s", -0.1, 0.1),
        ],
        actuators=[Actuator("i", safe=0.0, slew_per_s=100.0)],
        safe_output_effect="the carrier comes down",
    )
    fields: dict[str, Any] = {
        "reference": reference,
        "operating_points": {"middle": {"z": 0.0}},
        "cases": CASES,
        "tolerances": ["m"],
        "stops": {"z": (-1e-3, 1e-3)},
        "coordinates": {},
    }
    controller = stage.controller("carrier", Discrete(T), interface, [law(interface)])
    return stage.design(controller, plant, **(fields | changed))


STAGE = carrier()
