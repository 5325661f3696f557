"""Closed-loop simulation of the planar positioner: plant, noisy sensors, converters, one sample of delay, compiled C.

    pose ---> Hall voltages + noise ---> 16 bits over +-10 V --+
          |                                                    +--> controller ---> z^-delay ---> phase currents
          +-> distances + noise -------> 16 bits over +-10 V --+

The motors of the plant see the harmonics of the field, which the allocation neglects. Phase currents are held over a
sample, as by ideal amplifiers. `voltages` computes the voltages that they need.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from designs.planar_6dof import faults, filtering, interface
from designs.planar_6dof.sensing import sections as sensing
from models import halbach, planar_stage
from synth.block import Block, unranged
from synth.blocks.guard import safety
from synth.composition import compose
from synth.declare.stage import Interface, Stage
from synth.execute import host
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from synth.statespace import Array
from synth.timing import Discrete, period


def of(block: Block, controller: host.Controller | None = None, declared: Interface | None = None) -> Rig:
    """Return the closed loop of a controller, compiled here or given, on motors that see the field's harmonics.

    The interface is that of the three sensors of the stage unless it is given.
    """
    plant = planar_stage.plant(halbach.HARMONICS)
    chosen = declared or (interface.BRAKED if block.safety and block.safety.braking else interface.INTERFACE)
    named = interface.declare_controller(block.name, Discrete(period(block.time)), lambda: block, chosen)
    declared_stage = Stage(named, plant, substeps=interface.SUBSTEPS, faults=faults.CAMPAIGN)
    return Rig(declared_stage, plant, controller or compile_block(block))


def growing_circle(time: Array, radius: float, rate: float, growth: float) -> dict[str, Array]:
    """Return set-points x, y (N,) in m of a circle at a rate in rad/s, whose radius grows within `growth` s."""
    part = np.clip(time / growth, 0, 1)
    r = radius * part**3 * (10 - 15 * part + 6 * part**2)
    return {"x": r * np.cos(rate * time), "y": r * np.sin(rate * time)}


def simulate(
    rig: Rig, duration_s: float, references: Mapping[str, ArrayLike], start: Mapping[str, float], **options: Any
) -> Trajectory:
    """Run from rest at `start` by axis (m, rad), in the middle pitch, under set-points by axis; others stay there."""
    return rig.run(duration_s, start, {f"{axis}_ref": values for axis, values in references.items()}, **options)


def with_noise(rig: Rig, noise: float) -> Rig:
    """Return the loop with another position noise of its Hall sensors, a standard deviation in m."""
    volts = noise * interface.VOLTS_PER_METRE
    sensors = rig.stage.interface.sensors
    noisy = tuple(replace(s, noise=volts) if s.name in planar_stage.HALL else s for s in sensors)
    return rig.with_interface(sensors=noisy)


def position_noise(rig: Rig) -> float:
    """Return the noise of the Hall sensors as a standard deviation of position in m."""
    return rig.noise * rig.stage.interface.sensors[0].noise / interface.VOLTS_PER_METRE


def measured_positions(rig: Rig, trajectory: Trajectory) -> dict[str, Array]:
    """Return the raw and filtered positions of a run, ``x_raw`` and ``x``, as its controller computes them."""
    return positions_of_run(trajectory, rig.stage.controller.block)


def positions_of_run(run: Trajectory, block: Block) -> dict[str, Array]:
    """Return the raw positions and residuals of a run as its controller computes them, up to the latch.

    The positions behind the filters (6)-(16) are beside them, for a controller without filters too.
    """
    columns = _inner_signals(block).replay(run.measured).outputs
    return {name: np.asarray(values, dtype=np.float64) for name, values in columns.items()}


@cache
def _inner_signals(block: Block) -> host.Controller:
    """Return the controller with raw positions, residuals, and positions behind filters as outputs."""
    inside = {named.signal.name: (named.signal, expr) for named, expr in block.computed_signals}
    names = [s.name for s in (*sensing.RAW.values(), *sensing.RESIDUALS)]
    chosen = [inside[name] for name in (*names, sensing.READY.name)]
    output = {**block.output, **{signal.name: expr for signal, expr in chosen}}
    shown = replace(block, outputs=tuple(signal for signal, _ in chosen), output=output, faults=(), safety=None)
    parts = [shown, *filtering.blocks(block.time)]
    view = compose("view", parts, inputs=[s.name for s in block.inputs], outputs=[*names, *filtering.AXES])
    return compile_block(unranged(view))


def position_block(time: Discrete, predicted: bool = True) -> Block:
    """Return the Block from voltages to raw positions and residuals, `predicted` by the filters or not.

    Filtered positions are outputs in either case.
    """
    guard = safety.guard(time, interface.INPUTS, interface.BAD_SAMPLES, suspected=planar_stage.HALL)
    parts = [guard, sensing.sensing(planar_stage.plant(), time, predicted), *filtering.blocks(time)]
    outputs = [*(s.name for s in (*sensing.RAW.values(), *sensing.RESIDUALS)), *filtering.AXES]
    return unranged(compose("view", parts, inputs=[g.signal.name for g in interface.INPUTS], outputs=outputs))


def compile_block(block: Block, scalar: type[np.floating] = np.float32) -> host.Controller:
    """Return the compiled C of a Block, emitted as in the shipped controller."""
    return host.compile_block(block, scalar, error=interface.SURROGATE_ERROR[scalar])
