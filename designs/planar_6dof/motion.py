"""Prediction of x, y and phi from the achieved demands, and braking before the latch.

    raw positions ---->[ dead_reckoning ]---> predicted positions ---> sensing: bad samples, yaw, innovation
    acting demands ----^          '---------> predicted rates -------> [ braking ]---> demands
                                              demands of the law, 0 before the first complete sample ----^

The demand d that was achieved in the sample before acts until the next one. The LQG law has it as a state, another law
needs `delay`. Each axis is q'' = b d with d in A; b follows from force constant, arm and inertia. Both poles of an axis
are r = 1 - w T. The bandwidths w are a compromise of each design: a faster filter has forgotten the motion when a
channel that sticks is noticed, a slower one contradicts a sound measurement where the force differs from its model.

So slow a filter predicts a yaw rate at standstill, where the vertical currents of a tilted platen make a torque about
Z. The mean innovation shows that rate, and braking takes it into account. A converter that repeats its code is detected
by that, if the motion does not show it earlier. Figures: docs/decisions/planar_faults.md.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from designs.planar_6dof import allocation, interface, vertical
from designs.planar_6dof.allocation import HORIZONTAL
from designs.planar_6dof.sensing import sections as sensing
from synth.block import Block, Exprs, State, Step, build
from synth.blocks.estimate import dead_reckoning
from synth.blocks.faults import start
from synth.blocks.guard import safe_output
from synth.plant import Plant
from synth.signals import Signal
from synth.timing import Discrete

Bandwidth = Mapping[str, float]  # of x, y and phi, and of the force in x and y that is learnt, rad/s
FASTEST = {"x": 2.0, "y": 2.0, "phi": 40.0}  # m/s, rad/s: bounds of the predicted rates
SHARE = 0.5  # of the rates, removed in a braking sample
INERTIA = {"x": "M", "y": "M", "phi": "Izz"}
# A mean over 400 samples, and the samples until the latch. A lost laser leaves the yaw measured until then: its rate is
# corrected by a sixth too much.
LARGEST_FORCE = 32.0  # m/s^2, of cables and hoses: the 48 N that A and B make along y
BIAS = {"phi": dead_reckoning.RateBias(0.9975, interface.BAD_SAMPLES - 1 + interface.BRAKING)}


def acting(plant: Plant, axis: str) -> Signal:
    """Return the demand that acts until the next sample, within what the motors can achieve."""
    achieved, most = vertical.ACHIEVED_DEMAND[axis], allocation.achievable_bound(plant)[axis]
    return Signal(f"acting_{axis}", achieved.unit, -most, most, "demand that acts until the next sample")


def delay(plant: Plant, time: Discrete) -> Block:
    """Return the Block from the achieved demands to those that act: a delay of one sample."""
    later = {axis: acting(plant, axis) for axis in HORIZONTAL}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        achieved = {axis: u[vertical.ACHIEVED_DEMAND[axis].name] for axis in HORIZONTAL}
        return Step({signal.name: x[axis] for axis, signal in later.items()}, achieved)

    inputs, outputs = [vertical.ACHIEVED_DEMAND[axis] for axis in HORIZONTAL], list(later.values())
    states = [State(replace(signal, name=axis), 0.0) for axis, signal in later.items()]
    return build("delay", time, law, inputs=inputs, outputs=outputs, states=states, tag="delay of one sample")


def axes(plant: Plant, time: Discrete, bandwidth: Bandwidth) -> list[dead_reckoning.Axis]:
    """Return x, y and phi with their accelerations per A of demand."""
    scales = allocation.scales(plant)
    return [
        dead_reckoning.Axis(
            axis,
            sensing.RAW[axis],
            sensing.PREDICTED[axis],
            acting(plant, axis),
            scales[axis] / plant.parameter(INERTIA[axis]).value,
            FASTEST[axis],
            1 - bandwidth[axis] * time.period_s,
            BIAS.get(axis),
            dead_reckoning.Disturbance(1 - bandwidth["force"] * time.period_s, LARGEST_FORCE)
            if axis != "phi"
            else None,
        )
        for axis in HORIZONTAL
    ]


def prediction(plant: Plant, time: Discrete, bandwidth: Bandwidth) -> Block:
    """Return the Block from raw positions and acting demands to predicted positions and rates."""
    return dead_reckoning.block("reckoning", time, axes(plant, time, bandwidth))


def sensing_blocks(plant: Plant, time: Discrete, bandwidth: Bandwidth) -> list[Block]:
    """Return the Blocks from Hall voltages and acting demands to measured positions and their predictions."""
    return [sensing.sensing(plant, time, from_forces=True), prediction(plant, time, bandwidth)]


def add_braking(
    plant: Plant, time: Discrete, law: Sequence[Block], bandwidth: Bandwidth, notes: Sequence[str] = ()
) -> list[Block]:
    """Return a law whose horizontal demands brake before the latch; `notes` are sentences on it in the C."""
    demanded = {a: replace(s, name=f"law_{a}", about="demand of the law") for a, s in vertical.DEMAND.items()}
    names = {s.name: demanded[a].name for a, s in vertical.DEMAND.items()}
    blocks = [b.renamed(names) if {s.name for s in b.outputs} & set(names) else b for b in law]
    begun = {a: replace(demanded[a], name=f"begun_{a}") for a in HORIZONTAL}
    demands = {axis: (begun[axis], vertical.DEMAND[axis]) for axis in HORIZONTAL}
    moved = axes(plant, time, bandwidth)
    said = [*notes, removes({axis.name: axis.acceleration for axis in moved}, time)]
    started = start.block(time, {demanded[a]: begun.get(a, s) for a, s in vertical.DEMAND.items()})
    return [*blocks, started, safe_output.braking_block("braking", time, moved, demands, SHARE, said)]


def removes(acceleration: Mapping[str, float], time: Discrete) -> str:
    """Return which speeds braking removes, as a sentence, from the accelerations by 1 A."""
    samples = interface.BRAKING - 1  # in the last one it latches
    per_ampere = {axis: b * samples * time.period_s for axis, b in acceleration.items()}
    C, A_and_B = per_ampere["x"] * allocation.QUADRATURE / 2, per_ampere["y"] * 2 * allocation.QUADRATURE
    return (
        f"Each sample removes half of the predicted rate, within the limits of the currents. In the {samples} samples "
        f"before the latch motor C can remove {C:.3f} m/s from x, whatever the yaw demands; A and B can remove up to "
        f"{A_and_B:.2f} m/s from y, less what the yaw takes. What is left of a larger speed coasts."
    )
