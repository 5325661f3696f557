"""Standard sections of a report, one function per section.

    facts   model   law   gains   loops   experiments   audit   verification   cost   files

The section on faults is in `sections`. `template` combines them for a declared stage; other designs call the functions
that they need.
"""

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from synth import show
from synth.analyse.loops.stability_margins import Margins
from synth.block import Block
from synth.emit.write import EmittedCode
from synth.plant import Plant
from synth.report import bode, figures, page, sections
from synth.report.audit import Row
from synth.report.equations import display
from synth.report.equations.derive import NamedTerms
from synth.report.first_screen import AUDIT, EXPERIMENTS, LOOPS, VERIFICATION
from synth.report.notation import number
from synth.report.page import Section
from synth.report.sections import HEADROOM, Shown, by_channel, in_fine_units, window, with_units
from synth.signals import Signal
from synth.simulate.experiments import Experiment
from synth.statespace import StateSpace
from synth.timing import Discrete
from synth.verify.suite import Evidence

MODEL, LAW, GAINS, DATASHEET, FILES = "Model", "Control law", "Gains and certificates", "Datasheet", "Files"
WITNESSES = (
    "reference: NumPy, written from the equations, with independently computed gains. casadi: evaluation by CasADi. "
    "casadi_c: C of CasADi's code generator, double. c64, c32: the emitted C in double and single precision."
)
OPENED = (
    "Each loop is opened at one actuator or sensor, with all others closed. It contains the controller with rounded "
    "constants, the delay and the hold; plant and controller are linearised at rest. `gain up` and `gain down` are "
    "the factors, above and below 1, to which the gain may rise and fall."
)
AROUND = ("guard", "safe_output")  # Blocks that every controller has; their sections are collapsed


class Loop(Protocol):
    """A loop opened at a signal, at an operating point."""

    @property
    def signal(self) -> str:
        """The signal at which the loop is opened."""
        ...

    @property
    def label(self) -> str:
        """The label that distinguishes it from other loops opened at the same signal."""
        ...

    @property
    def L(self) -> StateSpace:
        """The open loop."""
        ...

    @property
    def margins(self) -> Margins:
        """Its margins."""
        ...


def facts(time: Discrete, scalar: type[np.floating], inputs: str, outputs: str) -> tuple[tuple[str, str], ...]:
    """Return the facts at the top of a report."""
    return (
        ("sample period", f"{time.period_s * 1e3:g} ms"),
        ("scalar type", np.dtype(scalar).name),
        ("inputs", inputs),
        ("outputs", outputs),
    )


def model(plant: Plant, terms: NamedTerms | None = None, blocks: Sequence[page.Block] = ()) -> Section:
    """Return the derived equations, signals and parameters of a plant, then further `blocks`.

    Raises ModelError as `display.plant`.
    """
    signals = display.signals("States and inputs", (*plant.states, *plant.inputs))
    derived = display.plant(plant, terms)
    tables = (signals, sections.parameters(plant))
    return Section(MODEL, (page.Text(display.LEGEND), *derived, *tables, *blocks))


def law(block: Block, blocks: Sequence[page.Block] = ()) -> Section:
    """Return the derived equations, inputs and outputs of a controller, then further `blocks`.

    Raises ModelError as `display.block`.
    """
    ends = display.signals("Inputs and outputs", (*block.inputs, *block.outputs))
    internal = [computed.signal for computed, _ in block.computed_signals if computed.signal not in block.outputs]
    tables = [
        display.signals("Internal signals", internal),
        display.signals("States", [s.signal for s in block.states]),
    ]
    tables += [display.constants(block)] if block.constants else []
    folded = page.Folded("Internal signals, states and constants", tuple(tables))
    return Section(LAW, (*display.block(block, AROUND), ends, folded, *blocks))


def gains(document: Mapping[str, Any]) -> Section:
    """Return the tables of gains.json: laws with equal entries share a table, one column per law."""
    return Section(GAINS, sections.gains_tables(document))


def loops(opened: Iterable[Loop], blocks: Sequence[page.Block] = ()) -> Section:
    """Return the Bode plots and margins of loops by loop-breaking point, below other `blocks`."""
    by_signal: dict[str, list[Loop]] = defaultdict(list)
    for loop in opened:
        by_signal[loop.signal].append(loop)
    parts = tuple(_loop(signal, each) for signal, each in by_signal.items())
    return Section(LOOPS, tuple(blocks), parts)


def _loop(signal: str, opened: Sequence[Loop]) -> Section:
    curves = [bode.curve(loop.label.removeprefix(f"at {signal}, "), loop.L, loop.margins) for loop in opened]
    name = figures.SYMBOLS.get(signal, signal)
    return sections.loop(f"Loop of {name}", f"bode-{signal}", curves)


def experiments(runs: Sequence[Experiment], shown: Shown, blocks: Sequence[page.Block] = ()) -> Section:
    """Return every run with its plot and checks, and the headroom of the states where it was measured.

    Raises SignalError when a unit is missing.
    """
    headroom = _headroom(runs)
    return Section(EXPERIMENTS, (*blocks, *headroom), tuple(_experiment(run, shown) for run in runs))


def _experiment(run: Experiment, shown: Shown) -> Section:
    shown = replace(shown, units={**run.trajectory.units, **shown.units})
    table, extra_blocks, time_window = (
        by_channel(run.figures, shown.channels),
        shown.blocks.get(run.name, ()),
        window(run, shown),
    )
    measured = {} if table else with_units(run.figures, shown.units)
    fine, fine_shown = in_fine_units(replace(run, figures=measured), shown)
    section = sections.experiment(
        fine, fine_shown.units, fine_shown.levels, time_window, shown.published.get(run.name, "")
    )
    return Section(section.title, (*section.blocks, *table, *extra_blocks), section.sections)


def _headroom(runs: Sequence[Experiment]) -> tuple[show.Table, ...]:
    """Return the largest |state| / bound of each run, and the state."""
    rows: list[tuple[show.Cell, ...]] = []
    for run in runs:
        for name, ratio in run.figures.items():
            if name.startswith(HEADROOM):
                rows.append((run.title, name.removeprefix(HEADROOM).strip(" ()"), ratio))
    caption = "Headroom of the states of the control laws: largest |state| / bound"
    return (show.Table(caption, ("experiment", "state", "ratio"), tuple(rows)),) if rows else ()


def audit(rows: Sequence[Row], blocks: Sequence[page.Block] = (page.Text("Verdicts are computed."),)) -> Section:
    """Return other `blocks` and the audit of the published values."""
    return Section(AUDIT, (*blocks, sections.audit(rows)))


def verification(evidence: Evidence, floor: str = "") -> Section:
    """Return the agreement of the witnesses and its checks; differences below the `floor` are relative to it."""
    text = page.Text(f"{WITNESSES} {f'The floor is {floor}.' if floor else ''}".strip())
    checks = page.Checks("Limits", tuple(evidence.checks))
    return Section(VERIFICATION, (text, sections.agreements(evidence.agreements), checks))


def datasheets(emitted: Mapping[str, EmittedCode]) -> Section:
    """Return the datasheet of each emitted Block, by folder."""

    def parts(sheets: Sequence[show.Sheet]) -> tuple[Section, ...]:
        return tuple(Section(s.title, (*map(page.Text, s.lines), *s.tables)) for s in sheets)

    return Section(DATASHEET, (), tuple(Section(folder, (), parts(each.datasheet)) for folder, each in emitted.items()))


def files(emitted: Mapping[str, EmittedCode]) -> Section:
    """Return the size and hash of each emitted file, by folder."""
    texts = {f"{folder}/{name}": text for folder, each in emitted.items() for name, text in each.files.items()}
    return Section(FILES, (sections.files(texts),))


def list_signals(signals: Iterable[Signal]) -> str:
    """Return the number and the names of signals as text."""
    names = [s.name for s in signals]
    return f"{number(len(names))}: {', '.join(names)}"
