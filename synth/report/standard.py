"""The standard sections of a report, for any design: each a function of what it shows.

    facts   model   law   gains   loops   experiments   faults   audit   verification   cost   files

`template` puts them together for a declared stage; a design of another kind calls those that it has use for.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol

import numpy as np

from synth.analyse.margins import Margins
from synth.block import Block
from synth.check import Check
from synth.emit.write import Emitted
from synth.plant import Plant
from synth.report import bode, figures, gains_table, page, sections
from synth.report.audit import Row
from synth.report.equations import display
from synth.report.equations.derive import Named
from synth.report.notation import number
from synth.report.page import Section
from synth.report.shown import HEADROOM, Shown, by_channel, in_fine_units, window, with_units
from synth.signals import Signal
from synth.simulate.experiment import Experiment
from synth.statespace import StateSpace
from synth.timing import Discrete
from synth.verify.evidence import Evidence

MODEL, LAW, GAINS, LOOPS = "Model", "Control law", "Gains and certificates", "Loops and margins"
EXPERIMENTS, FAULTS, AUDIT = "Experiments", "Faults", "Audit of the paper"
VERIFICATION, COST, FILES = "Verification", "Cost", "Files"
WITNESSES = (
    "reference: NumPy, written from the equations, with gains of its own. casadi: CasADi's evaluation. casadi_c: "
    "CasADi's own C, double. c64, c32: the emitted C in double and single precision."
)
OPENED = (
    "Each loop is opened at one actuator or sensor, all others closed: the rounded controller as it ships, the delay, "
    "the hold, and both plant and controller linearised where the loop rests. A gain margin below 1 is the factor down "
    "to which the gain may fall."
)
AROUND = ("guard", "safe_output")  # Blocks that every controller has, folded away


class Loop(Protocol):
    """A loop that is opened at a signal, at an operating point."""

    @property
    def signal(self) -> str:
        """Where it is opened."""
        ...

    @property
    def label(self) -> str:
        """What tells it from others that are opened there."""
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
    """Return what stands at the top of a report."""
    return (
        ("sample period", f"{time.period_s * 1e3:g} ms"),
        ("scalar type", np.dtype(scalar).name),
        ("inputs", inputs),
        ("outputs", outputs),
    )


def model(plant: Plant, named: Named | None = None, blocks: Sequence[page.Block] = ()) -> Section:
    """Return a plant's derived equations, its signals and parameters, then further `blocks`.

    Raises ModelError as `display.plant`.
    """
    signals = display.signals("States and inputs", (*plant.states, *plant.inputs))
    derived = display.plant(plant, named)
    tables = (signals, sections.parameters(plant))
    return Section(MODEL, (page.Text(display.LEGEND), *derived, *tables, *blocks))


def law(block: Block, blocks: Sequence[page.Block] = ()) -> Section:
    """Return a controller's derived equations, its inputs and outputs, then further `blocks`.

    Raises ModelError as `display.block`.
    """
    ends = display.signals("Inputs and outputs", (*block.inputs, *block.outputs))
    inside = [named.signal for named, _ in block.inside if named.signal not in block.outputs]
    tables = [display.signals("Signals inside", inside), display.signals("States", [s.signal for s in block.states])]
    tables += [display.constants(block)] if block.constants else []
    folded = page.Folded("Signals inside, states and constants", tuple(tables))
    return Section(LAW, (*display.block(block, AROUND), ends, folded, *blocks))


def gains(document: Mapping[str, Any]) -> Section:
    """Return what gains.json says of each law: a column a law where their entries are alike, else a table each."""
    return Section(GAINS, gains_table.tables(document))


def loops(opened: Iterable[Loop], required: Sequence[Check] = (), blocks: Sequence[page.Block] = ()) -> Section:
    """Return the Bode plots and margins of loops by where they are opened, and the margins that are required."""
    by_signal: dict[str, list[Loop]] = defaultdict(list)
    for loop in opened:
        by_signal[loop.signal].append(loop)
    checks = (page.Checks("Required margins", tuple(required)),) if required else ()
    parts = tuple(_loop(signal, each) for signal, each in by_signal.items())
    return Section(LOOPS, (*blocks, *checks), parts)


def _loop(signal: str, opened: Sequence[Loop]) -> Section:
    curves = [bode.curve(loop.label.removeprefix(f"at {signal}, "), loop.L, loop.margins) for loop in opened]
    name = figures.SYMBOLS.get(signal, signal)
    return sections.loop(f"Loop of {name}", f"bode-{signal}", curves)


def experiments(runs: Sequence[Experiment], shown: Shown, blocks: Sequence[page.Block] = ()) -> Section:
    """Return every run with its figure and checks, and how near states came to their bounds where that was measured.

    Raises SignalError when a unit is missing.
    """
    near = _headroom(runs)
    return Section(EXPERIMENTS, (*blocks, *near), tuple(_experiment(run, shown) for run in runs))


def _experiment(run: Experiment, shown: Shown) -> Section:
    table, drawn, part = by_channel(run.figures, shown.channels), shown.drawn.get(run.name, ()), window(run, shown)
    measured = {} if table else with_units(run.figures, shown.units)
    fine, by = in_fine_units(replace(run, figures=measured), shown)
    section = sections.experiment(fine, by.units, by.levels, part, shown.beside.get(run.name, ""))
    return Section(section.title, (*section.blocks, *table, *drawn), section.sections)


def _headroom(runs: Sequence[Experiment]) -> tuple[page.Table, ...]:
    """Return the largest |state| / bound of each run and whose it is."""
    rows: list[tuple[page.Cell, ...]] = []
    for run in runs:
        for name, ratio in run.figures.items():
            if name.startswith(HEADROOM):
                rows.append((run.title, name.removeprefix(HEADROOM).strip(" ()"), ratio))
    caption = "How near the states of the laws came to their bounds: largest |state| / bound"
    return (page.Table(caption, ("experiment", "state", "ratio"), tuple(rows)),) if rows else ()


def audit(rows: Sequence[Row], blocks: Sequence[page.Block] = (page.Text("Verdicts are computed."),)) -> Section:
    """Return the published figures recomputed, behind other `blocks`."""
    return Section(AUDIT, (*blocks, sections.audit(rows)))


def verification(evidence: Evidence, floor: str = "", apart: Callable[[Check], bool] = lambda check: False) -> Section:
    """Return how the witnesses agree and the checks drawn from that, without those that are shown `apart`.

    `floor` says below what a difference is absolute.
    """
    text = page.Text(f"{WITNESSES} {f'The floor is {floor}.' if floor else ''}".strip())
    checks = tuple(check for check in evidence.checks if not apart(check))
    return Section(VERIFICATION, (text, sections.agreements(evidence.agreements), page.Checks("Limits", checks)))


def files(emitted: Mapping[str, Emitted]) -> Section:
    """Return the size and hash of each emitted file, by folder."""
    texts = {f"{folder}/{name}": text for folder, each in emitted.items() for name, text in each.files.items()}
    return Section(FILES, (sections.files(texts),))


def list_signals(signals: Iterable[Signal]) -> str:
    """Return signals as a text: how many, and which."""
    names = [s.name for s in signals]
    return f"{number(len(names))}: {', '.join(names)}"
