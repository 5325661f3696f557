"""Report of a planar design for a design review, from report.md, report.toml and computed figures and tables.

Both designs share the sections on stage, sensing, filter, experiments, failures, audit and verification. Each adds its
control law and its loops.
"""

import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import casadi as ca
import numpy as np
from matplotlib.figure import Figure

from designs.planar_6dof import allocation, cost_stimuli, drawings, loops
from designs.planar_6dof import loop as simulated
from designs.planar_6dof.sensing import calibration
from designs.planar_6dof.sensing import maps as sensing_maps
from models import planar_stage
from synth.block import Block
from synth.declare.stage import Stage
from synth.plant import Plant, Symbols
from synth.report import page, prose, sections, standard
from synth.report.audit import Row
from synth.report.figures import SYMBOLS
from synth.report.notation import readable
from synth.report.page import Section
from synth.report.prose import Content, Value
from synth.report.sections import PublishedFigures, Shown, published_figures, window
from synth.report.template import Extra, Results
from synth.simulate.experiments import Experiment
from synth.simulate.scenario import Trajectory
from synth.timing import Discrete
from synth.verify.suite import Evidence

SHOWN = Shown(
    {s.name: s.unit for s in (*planar_stage.STATES, *planar_stage.INPUTS, *planar_stage.OUTPUTS)},
    latch=(0.1, 0.05),  # the platen then coasts without current
    fine=5e-4,
    channels=planar_stage.HALL,
)
MAP_POINTS = 41  # places over a pitch in x and in y of a map, one at which voltages are 0
PLACES = 9  # over a pitch in x and in y, from which the platen moves with a stuck channel
REST, SPECTRUM, CIRCLE, FINITE = "standstill", "step_x", "circle", "_finite"  # runs by name
OF_RUN = "run."  # prefix of the figures of a run
SETTLING_S = 1.0  # s at the start of a run that are left out
WINDOW_S = (1.0, 3.0)  # s of the standstill that are drawn


@dataclass(frozen=True, eq=False)
class Contents:
    """Contents that a design adds to its report: controller, a line on its law, printed equations, and loops.

    `whole` are sections on multivariable loops. `published` maps experiments to rows of the audit. `filters_positions`
    is whether the law filters the positions, `spectrum` whether the paper shows a spectrum. `values` are those named in
    its report.md; `cost` returns tables that follow the cost.
    """

    block: Block
    line: str
    equations: Sequence[tuple[str, str]]
    loops: Sequence[loops.OpenLoop]
    published: PublishedFigures
    whole: Sequence[Section] = ()
    filters_positions: bool = True
    spectrum: bool = False
    values: Mapping[str, Value] = field(default_factory=dict)
    cost: Callable[[Sequence[Experiment]], tuple[page.Block, ...]] = lambda _: ()


def extra(contents: Callable[[Plant], Contents], stage: Stage, results: Results) -> Extra:
    """Return what the report of a design has beyond the standard, with all its experiments."""
    runs = results.runs
    plant = planar_stage.plant()  # the motors of the stage see harmonics, which the equations leave out
    design, data = contents(plant), tomllib.loads(Path(__file__).with_name("report.toml").read_text(encoding="utf-8"))
    block, time = design.block.rounded(np.float32), design.block.time
    computed = {
        **_stage(plant, block),
        **_over_pitch(results.evidence),
        **_at_rest(runs, time, design),
        **_run_figures(runs, design),
    }
    values = prose.with_captions(computed, data["blocks"])
    loop_part = standard.loops(design.loops)
    return Extra(
        {**values, **design.values},
        [
            standard.model(plant, _forces),
            replace(loop_part, sections=(*design.whole, *loop_part.sections)),
            experiments(design, runs, results.rows, values),
        ],
        facts=(("law", design.line),),
        law=(page.Equations((*design.equations, *map(tuple, data["equations"]["upright"]))),),
        cost=design.cost,
        shared=("planar_6dof",),
        floor=f"{cost_stimuli.FLOOR:g} A",
    )


def _forces(x: Symbols, u: Symbols, p: Symbols) -> dict[str, ca.SX]:
    """Return the force of each motor along its motion by name, from the equations of motion."""
    return {f"f_{motor}": f.y for motor, f in planar_stage.motor_forces(x, u, p).items()}


def _stage(plant: Plant, block: Block) -> dict[str, Content]:
    """Return figures and tables of the stage: derived parameters, sensing, loops and failures."""
    K, M, a, Izz = allocation.force_constant(plant), *(plant.parameter(n).value for n in ("M", "a", "Izz"))
    silent = sensing_maps.zero_voltages(plant, block.time, MAP_POINTS)
    failed = {"zero": silent, "stuck": sensing_maps.stuck_voltages(plant, block.time, PLACES)}
    return {
        "stage.derived": [
            ("K", K, "N/A", "force of a motor per ampere, (17) with 3/(2π)"),
            ("K / M", K / M, "m/s²/A", "(26) prints 13.2547, which carries the factor 1/2 of (17)"),
            ("K a / Izz", K * a / Izz, "rad/s²/A", "(26) prints 117.15"),
            ("A", calibration.of(plant).amplitude, "V", "amplitude of a Hall voltage's fundamental"),
            ("A γ", calibration.of(plant).volts_per_metre / 1e3, "V/mm", "its slope where it is 0"),
        ],
        "sensing.pitch": drawings.pitch(plant),
        "sensing.yaw": drawings.yaw_maps(plant),
        "speed": sensing_maps.SPEED,
        "failures.places": drawings.undetected_failures(
            plant, {name: (w.noticed < 0).reshape(MAP_POINTS, MAP_POINTS) for name, w in silent.items()}
        ),
        "failures.table": [(n, kind, *w.summary(n).values()) for kind, of in failed.items() for n, w in of.items()],
    }


def _over_pitch(evidence: Evidence) -> dict[str, Content]:
    """Return the ranges of the margins of each axis over the places on the pitch, from the loops of the build."""
    places = [loop for loop in evidence.loops.loops if loop.point != loops.IN_THE_MIDDLE] if evidence.loops else []
    by_axis = {axis: [loop.margins for loop in places if loop.signal == axis] for axis in allocation.AXES}
    ranges = [(SYMBOLS.get(axis, axis), *sections.margins_ranges(each)) for axis, each in by_axis.items() if each]
    return {"loops.places": loops.PLACES, "loops.pitch": ranges}


def _at_rest(runs: Sequence[Experiment], time: Discrete, design: Contents) -> dict[str, Content]:
    """Return the figure of the filter at a standstill; nothing for a law without filters."""
    if not design.filters_positions:
        return {}
    rest = [e.trajectory for e in runs if e.name == REST]
    if not rest:
        return {"sensing.filtered": "No run at rest was handed in.", "sensing.left": np.nan}
    window = slice(*(round(t / time.period_s) for t in WINDOW_S))
    measured = simulated.positions_of_run(rest[0], design.block)
    raw, filtered = measured["x_raw"][window], measured["x"][window]
    figure = drawings.before_and_after(rest[0].time[window], raw, filtered)
    return {"sensing.filtered": figure, "sensing.left": 100 * float(np.std(filtered) / np.std(raw))}


def _run_figures(runs: Sequence[Experiment], design: Contents) -> dict[str, Content]:
    """Return the paths of circles, and the spectrum of a step where the paper shows one."""
    rest = [e.trajectory for e in runs if e.name == REST]
    figures: dict[str, Content] = {}
    for e in runs:
        if e.name.removesuffix(FINITE) == CIRCLE:
            paths = ([np.asarray(source[n]) for n in "xy"] for source in (e.references, e.trajectory))
            figures[f"{OF_RUN}{e.name}"] = drawings.circle(*paths)
        if design.spectrum and e.name == SPECTRUM:
            figures[f"{OF_RUN}{e.name}"] = _spectrum(e.trajectory, rest, design.block)
    return figures


def _spectrum(step: Trajectory, rest: Sequence[Trajectory], block: Block) -> Figure:
    records, part = {}, round(SETTLING_S / block.time.period_s)
    for label, run in zip(("step of x", "at rest"), (step, *rest), strict=False):
        records[label] = simulated.positions_of_run(run, block)["x_raw"][part:]
    return drawings.spectra(records, block.time.period_s)


def experiments(
    design: Contents, runs: Sequence[Experiment], rows: Sequence[Row], values: Mapping[str, Value]
) -> Section:
    """Return the section of all runs with the paper's statements; runs over the finite matrix get the same ones."""
    quoted = published_figures(design.published, rows)
    texts = {e.name: readable(quoted.get(e.name.removesuffix(FINITE), "")) for e in runs}
    blocks = {name.removeprefix(OF_RUN): each for name, each in values.items() if name.startswith(OF_RUN)}
    figures = {name: (each,) for name, each in blocks.items() if isinstance(each, page.Figure)}
    return standard.experiments([_readable(e) for e in runs], replace(SHOWN, published=texts, blocks=figures))


def _readable(e: Experiment) -> Experiment:
    """Return an experiment with title and text in readable notation."""
    about = readable(e.about) + ("; drawn around the latch" if window(e, SHOWN) else "")
    first, space, rest = readable(e.title).partition(" ")
    return replace(e, title=f"{SYMBOLS.get(first, first)}{space}{rest}", about=about)
