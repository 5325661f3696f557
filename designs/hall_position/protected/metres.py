"""Position in m from phases: pitches are counted while a track lasts, from the one of the body at its acquisition.

n <- n + 1 where the phase falls by more than pi from a tracked sample to the next, n - 1 where it rises so
X = (phase + 2 pi n) / w;    n stays at the end of its range once it is there, and nothing is valid
"""

from math import pi

import casadi as ca

from designs.hall_position.glsdc import planar
from models.hall_two_waves import PlanarArray, SpatialArray
from synth.block import Block, Exprs, State, Step, build, clip
from synth.blocks.guard.safety import limit
from synth.law import label
from synth.signals import Signal
from synth.timing import Discrete

ROUNDING = 1e-6  # relative, of a range in single precision
AXES = {"x": "X", "y": "Y"}
PREFIXES = ("deviation", "protection")
VALID = Signal("valid", "1", 0, 1, "converged, tracked, passes its test, within its protection levels and pitches")


def metres(array: PlanarArray | SpatialArray, time: Discrete, pitches: int, phases: Block) -> Block:
    """Return the Block from phases, deviations and protection levels to m; it counts `pitches` to either side."""
    by_name = {s.name: s for s in phases.outputs}
    rounded = (1 - ROUNDING) * array.wave_number
    scaled = {f"{p}_{AXES[a]}": by_name[f"{p}_phase_{a}"] for p in PREFIXES for a in AXES}
    far = (pitches + 2) * array.pitch
    positions = [Signal(axis, "m", -far, far, f"position of the body's origin along {axis}") for axis in AXES.values()]
    about = {n: s.about.replace(s.name.partition("_")[2], n[-1]) for n, s in scaled.items()}
    sizes = [Signal(n, "m", s.low / rounded, s.high / rounded, about[n]) for n, s in scaled.items()]
    counts = {a: Signal(f"pitch_{a}", "1", -pitches - 1, pitches + 1, f"pitches along {a}") for a in AXES}

    numbers = [
        *planar.position_numbers(array),
        limit("most_pitches", pitches, "1", "counted to either side"),
        limit("end_of_count", pitches + 1, "1", "pitches at which counting stays"),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        output = {name: u[s.name] / array.wave_number for name, s in scaled.items()}
        next: dict[str, ca.SX] = {}
        valid = u["phases_valid"]
        for a, axis in AXES.items():
            change = u[f"phase_{a}"] - x[f"last_{a}"]
            before = x[f"pitch_{a}"]
            counted = ca.logic_and(ca.fabs(before) <= pitches, x["counting"])
            turned = ca.if_else(change < -pi, before + 1, ca.if_else(change > pi, before - 1, before))
            count = ca.if_else(u["tracking"], ca.if_else(counted, clip(turned, counts[a]), before), 0)
            output[axis] = u[f"phase_{a}"] / array.wave_number + array.pitch * count
            valid = ca.logic_and(valid, ca.fabs(count) <= pitches)
            next |= {f"last_{a}": u[f"phase_{a}"], f"pitch_{a}": count}
            label(a, change=change, turned=turned, count=count)
        label(valid=valid)
        return Step(output | {"valid": valid}, next | {"counting": u["tracking"]}, numbers=numbers)

    needed = [*(f"phase_{a}" for a in AXES), *(s.name for s in scaled.values()), "tracking"]
    inputs = [*(by_name[name] for name in needed), Signal("phases_valid", "1", 0, 1, "before pitches are counted")]
    states = [State(Signal(f"last_{a}", "rad", -pi, pi, "phase of the last sample"), 0.0) for a in AXES]
    states += [State(counts[a], 0.0) for a in AXES]
    states.append(State(Signal("counting", "1", 0, 1, "the last sample was tracked"), 0, True))
    return build("metres", time, law, inputs=inputs, outputs=[*positions, *sizes, VALID], states=states)
