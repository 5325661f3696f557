"""The loops of x, y and yaw closed by the estimate: the controller, the filters' lag, a sample of delay, the stage.

    i_AQ .. i_CD                                                          x, y, phi behind their filters, z, theta, psi
    ---*--->[ delay, hold, motors, stage ]--->[ 200 Hz, sampler ]-----*--->[ Hall sensors, lasers, controller ]---+
       ^                                                                                                          |
       +----------------------------------------------------------------------------------------------------------+

As `designs.planar_6dof.loops`, whose cuts these are. The field is model (2). One filter of the first order for each
voltage is one for each of x, y and yaw, as the voltages are linear in small motions; that of the upright axes, which
move the voltages too, is left out.
"""

from collections.abc import Mapping
from dataclasses import replace

import casadi as ca
import numpy as np

from designs.hall_position import shipped
from designs.hall_position.loop import closed_loop
from designs.hall_position.loop.closed_loop import Source
from designs.planar_6dof import loops, lqg
from designs.planar_6dof import page as planar
from designs.planar_6dof.allocation import AXES, HORIZONTAL
from designs.planar_6dof.loops import PHASES, SENSED, Parts, Place
from models import concentrated_field, hall_array, planar_stage
from models.hall_chain import Chain
from models.hall_two_waves import PlanarArray as Sensors
from synth.analyse import linearise, loop, trim
from synth.block import Block
from synth.report import page, standard
from synth.report.figures import SYMBOLS
from synth.signals import names
from synth.statespace import Array, StateSpace

ESTIMATE, SECTIONS = "estimate, three sensors", "sections, three sensors"
PLACES = 3  # over a pitch
SETTLED = 300  # samples after which the estimate rests
SPATIAL = {"x": 0, "y": 1, "z": 2, "theta": 3, "psi": 4, "phi": 5}  # in hall_array.SPATIAL


def section(points: int = PLACES) -> page.Section:
    """Return the loops that the estimate closes beside those that the sections close."""
    source = Source(shipped.array(shipped.THREE))
    plant = planar_stage.plant()
    block = closed_loop.controller(lqg.NAME, plant, lqg.TIME, lqg.law(plant), source).rounded(np.float32)
    found = opened(source, block, {})
    shown = loops.of_parts(found, HORIZONTAL, ESTIMATE)
    sections = loops.whole(plant, lqg.TIME, lqg.sensed(plant), lqg.law(plant))
    shown += loops.of_block(plant, sections, HORIZONTAL, SECTIONS)
    blocks = (_over_pitch(source, block, points),)
    return page.Section(standard.LOOPS, blocks, tuple(planar.bodes(shown, axis) for axis in HORIZONTAL))


def _over_pitch(source: Source, block: Block, points: int) -> page.Table:
    rows = []
    l = source.array.pitch
    spread = [
        {"x": l * ((k + 0.5) / points - 0.5), "y": l * ((3 * k % points + 0.5) / points - 0.5)} for k in range(points)
    ]
    found = [loops.of_parts(opened(source, block, place), HORIZONTAL, ESTIMATE) for place in spread]
    for k, axis in enumerate(HORIZONTAL):
        each = [f[k].margins for f in found]
        crossing = [max(c.frequency for c in m.gain_crossings) / (2 * np.pi) for m in each]
        rest = ([m.phase_margin for m in each], [m.gain_margin for m in each], [m.peak_sensitivity for m in each])
        stable = "yes" if all(m.stable for m in each) else "NO"
        rows.append((SYMBOLS.get(axis, axis), stable, *(f"{min(v):.3g} .. {max(v):.3g}" for v in (crossing, *rest))))
    columns = ("axis", "all stable", "crossover, Hz", "phase margin, °", "gain margin, ×", "Ms")
    return page.Table(f"The loops closed by the estimate at {points} places of a pitch", columns, tuple(rows))


def opened(source: Source, block: Block, place: Place) -> Parts:
    """Return both parts of the loop with the platen at rest at a place, m."""
    plant, pose = planar_stage.plant(), {**loops.MIDDLE, **place}
    stage, E = linearise.linearise(plant, trim.trim(plant, pose, [])), loops.commutation_matrix(plant, pose)
    motors = stage.select(AXES, PHASES)
    volts, slopes = sensed(source.array, pose)
    upright = stage.select(planar_stage.LASERS, ()).C[:, [stage.states.index(axis) for axis in AXES]]
    shown = np.vstack([slopes, upright])
    distances = upright @ [pose[axis] for axis in AXES]
    inputs = dict(zip(SENSED, [*volts.tolist(), *distances.tolist()], strict=True))
    inputs |= {f"{axis}_ref": pose[axis] for axis in AXES}
    K = loop.linearised(block, rested(block, begun(block, source.array, pose), inputs), inputs)
    return loops.around(filtered(motors, Chain()), K, shown, E)


def filtered(motors: StateSpace, chain: Chain) -> StateSpace:
    """Return motors to positions with x, y and phi behind a filter of the chain's corner."""
    behind = [AXES.index(axis) for axis in HORIZONTAL]
    w, C = 2 * np.pi * chain.corner, np.array(motors.C)
    n, k = len(motors.states), len(behind)
    A = np.block([[motors.A, np.zeros((n, k))], [w * C[behind], -w * np.eye(k)]])
    B = np.vstack([motors.B, np.zeros((k, len(motors.inputs)))])
    C[behind] = 0.0
    late = np.zeros((len(AXES), k))
    late[behind, range(k)] = 1.0
    states = (*motors.states, *(f"filtered_{axis}" for axis in HORIZONTAL))
    return replace(motors, A=A, B=B, C=np.hstack([C, late]), states=states, units={})


def sensed(of: Sensors, pose: Place) -> tuple[Array, Array]:
    """Return the Hall voltages (6,) at a pose in the field of model (2), and their slopes (6, 6) by AXES."""
    chain = Chain()
    sizes = {1: of.alpha / chain.gain, 5: of.beta / chain.gain}
    waves = concentrated_field.fitted(sizes, hall_array.HEIGHT, concentrated_field.values())
    array = hall_array.points(of.positions)
    q = np.zeros(len(hall_array.SPATIAL))
    for axis, k in SPATIAL.items():
        q[k] = pose[axis] + (hall_array.HEIGHT if axis == "z" else 0.0)
    volts, H = (v.full() for v in hall_array.spatial(array, waves).function()(q))
    return volts.ravel(), H[:, [SPATIAL[axis] for axis in AXES]]


def begun(block: Block, of: Sensors, pose: Place) -> dict[str, float]:
    """Return the initial states of a controller whose estimator knows that the platen is at a place, without yaw."""
    found = {s.name: float(v) for s, v in zip(block.states, block.initial, strict=True)}
    for axis, centre in zip("xy", of.centre, strict=True):
        at = (pose[axis] + centre) / of.pitch
        found |= {f"estimator_phase_{axis}": 2 * np.pi * (at - round(at)), f"estimator_pitch_{axis}": round(at)}
    return found | {"estimator_searching": 0.0}


def rested(block: Block, state: Mapping[str, float], inputs: Mapping[str, float]) -> dict[str, float]:
    """Return the states of a controller that has had the same inputs for long."""
    step, x, u = block.function(), ca.DM(list(state.values())), [inputs[name] for name in names(block.inputs)]
    for _ in range(SETTLED):
        x, _ = step(x, u)
    return {s.name: float(v) for s, v in zip(block.states, np.asarray(x).ravel(), strict=True)}
