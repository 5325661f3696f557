"""Loop transfer functions of x, y and yaw with the Hall estimator in the loop, and their margins over the pitch.

    i_AQ .. i_CD                                                          filtered x, y, phi; z, theta, psi
    ---*--->[ delay, hold, motors, stage ]--->[ 200 Hz, sampler ]-----*--->[ Hall sensors, lasers, controller ]---+
       ^                                                                                                          |
       +----------------------------------------------------------------------------------------------------------+

The loops are opened as in `designs.planar_6dof.loops`. The field is model (2). For small motions the voltages are
linear in the positions, and a first-order filter for each voltage is equivalent to one for each of x, y and yaw. The
vertical axes also change the voltages; the lag of the filters on this path is neglected.

"Sections" is the sensing of `designs.planar_6dof`, which inverts the Hall voltages section by section of the pitch.
"""

import numpy as np

from designs.hall_position.paper import layouts
from designs.planar_6dof import loops, lqg
from designs.planar_6dof.allocation import AXES, HORIZONTAL
from designs.planar_6dof.loops import PHASES, SENSED, LoopParts, Place
from models import hall_array, hall_chain, hall_two_waves, planar_stage
from models.hall_chain import Chain
from models.hall_stage import Stage
from models.hall_two_waves import PlanarArray as Sensors
from studies.hall.loop import closed_loop
from studies.hall.loop.closed_loop import Source
from synth import show
from synth.analyse import operating_points
from synth.analyse.loops import loop
from synth.block import Block
from synth.report import page, sections, standard
from synth.report.figures import SYMBOLS
from synth.statespace import Array
from synth.verify import agree, replays

ESTIMATE, SECTIONS = "estimate, three sensors", "sections, three sensors"
PLACES = 3  # positions over a pitch, at each of which the loops are linearised
SETTLING_SAMPLES = 300  # samples of constant inputs after which the estimator is in steady state
SPATIAL = ("x", "y", "z", "theta", "psi", "phi")  # as in hall_array.SPATIAL


def section(points: int = PLACES) -> page.Section:
    """Return the loops with the estimator, with the sensing by sections for comparison."""
    source = Source(Stage().array(layouts.LAYOUTS[5]))
    plant = planar_stage.plant()
    block = closed_loop.controller(lqg.NAME, plant, lqg.TIME, lqg.law(plant), source).rounded(np.float32)
    parts = open_loop(source, block, {})
    open_loops = loops.of_parts(parts, HORIZONTAL, ESTIMATE)
    by_sections = loops.rounded_controller(plant, lqg.TIME, lqg.sensing_blocks(plant), lqg.law(plant))
    open_loops += loops.of_block(plant, by_sections, HORIZONTAL, SECTIONS)
    return standard.loops(open_loops, blocks=(_over_pitch(source, block, points),))


def _over_pitch(source: Source, block: Block, points: int) -> show.Table:
    places = loops.places_over_pitch(source.array.pitch, points)
    by_place = [loops.of_parts(open_loop(source, block, place), HORIZONTAL, ESTIMATE) for place in places]
    rows = []
    for axis, axis_loops in zip(HORIZONTAL, zip(*by_place, strict=True), strict=True):
        margins = [o.margins for o in axis_loops]
        stable = "yes" if all(m.stable for m in margins) else "NO"
        rows.append((SYMBOLS.get(axis, axis), stable, *sections.margins_ranges(margins)))
    caption = f"The loops closed by the estimate at {points} places of a pitch"
    return show.Table(caption, ("axis", "all stable", *sections.RANGES), tuple(rows))


def open_loop(source: Source, block: Block, place: Place) -> LoopParts:
    """Return stage and controller, linearised about the platen at rest at a place in m and rad."""
    plant, pose = planar_stage.plant(), {**loops.MIDDLE, **place}
    stage = operating_points.linearise(plant, operating_points.trim(plant, pose, []))
    E = loops.commutation_matrix(plant, pose)
    motors = stage.select(AXES, PHASES)
    volts, slopes = voltages_and_slopes(source.array, pose)
    laser_matrix = stage.select(planar_stage.LASERS, ()).C[:, [stage.states.index(axis) for axis in AXES]]
    measurement = np.vstack([slopes, laser_matrix])
    distances = laser_matrix @ [pose[axis] for axis in AXES]
    inputs = dict(zip(SENSED, [*volts.tolist(), *distances.tolist()], strict=True))
    inputs |= {f"{axis}_ref": pose[axis] for axis in AXES}
    constant_inputs = {name: np.full(SETTLING_SAMPLES, value) for name, value in inputs.items()}
    steady_states = replays.run(agree.casadi(block), initial_states(block, source.array, pose), constant_inputs).states
    K = loop.linearise_block(block, {name: float(value[0]) for name, value in steady_states.items()}, inputs)
    return loops.in_motor_coordinates(hall_chain.with_filter(motors, HORIZONTAL, Chain()), K, measurement, E)


def voltages_and_slopes(sensors: Sensors, pose: Place) -> tuple[Array, Array]:
    """Return the Hall voltages (6,) at a pose in the field of model (2), and their slopes (6, 6) by AXES."""
    q = [pose[axis] + (hall_array.HEIGHT if axis == "z" else 0.0) for axis in SPATIAL]
    volts, H = (v.full() for v in hall_array.spatial(*hall_two_waves.model(sensors)).function()(q))
    return volts.ravel(), H[:, [SPATIAL.index(axis) for axis in AXES]]


def initial_states(block: Block, sensors: Sensors, pose: Place) -> dict[str, float]:
    """Return the initial states of a controller whose estimator tracks from a place, at yaw 0, without a search."""
    states = {s.name: s.initial for s in block.states}
    for axis, centre in zip("xy", sensors.centre, strict=True):
        pitches = (pose[axis] + centre) / sensors.pitch
        states |= {f"estimator_phase_{axis}": 2 * np.pi * (pitches - round(pitches))}
        states[f"estimator_pitch_{axis}"] = round(pitches)
    return states | {"estimator_searching": 0.0}
