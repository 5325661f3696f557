"""Audit of the lead-lag loops: crossovers and margins, steps, the vertical axes; `axes` says on which loop."""

from collections.abc import Mapping
from dataclasses import replace
from typing import NamedTuple

from designs.planar_6dof.paper import axes
from designs.planar_6dof.paper.axes import Axis, Step
from designs.planar_6dof.paper.bench import Bench
from synth.report.audit import Outcome, Published, recomputes

OVERSHOOT = 0.25  # relative: "around 20 %" is 15 to 25 %
KHZ = 1e3
SCALES = {"rise": (1e3, "ms"), "overshoot": (1.0, "%"), "settled": (1e3, "ms")}  # of the figures of a Step


class Source(NamedTuple):
    """What an axis follows from: its inertia, its spring, and the prefix of its printed compensator."""

    inertia: str
    spring: str
    prefix: str

    def names(self) -> tuple[str, ...]:
        """Return the parameters and printed numbers."""
        stage = (self.inertia, self.spring) if self.spring else (self.inertia,)
        return (*stage, *(f"{self.prefix}{n}" for n in ("gain", "lead", "lag", "reset")))


HORIZONTAL = {"x": Source("M", "", "Y-7."), "phi": Source("Izz", "", "Y-8.")}
VERTICAL = {
    "z": Source("M", "Kz", "Y-32.z_"),
    "theta": Source("Ixx", "K_theta", "Y-32.theta_"),
    "psi": Source("Iyy", "K_psi", "Y-32.psi_"),
}
X, PHI, THETA = HORIZONTAL["x"].names(), HORIZONTAL["phi"].names(), VERTICAL["theta"].names()


@recomputes("Y-7", *X, "Y-7.crossover", "Y-7.margin", "Y-7.rate", "Y-7.rate_lqg")
def crossover_of_x(bench: Bench, printed: Published) -> Outcome:
    """Recompute crossover and phase margin of x and y."""
    return _crossover(bench, printed, axis(bench, "x"))


@recomputes("Y-8", *PHI, "Y-8.crossover", "Y-8.margin", "Y-7.rate", "Y-7.rate_lqg")
def crossover_of_phi(bench: Bench, printed: Published) -> Outcome:
    """Recompute crossover and phase margin of phi."""
    return _crossover(bench, printed, axis(bench, "phi"))


def _crossover(bench: Bench, printed: Published, of: Axis) -> Outcome:
    """The printed crossover and margin enter the last three figures."""
    T = _period(bench)
    cases = {
        "continuous": axes.margin(of),
        "held at 1 kHz": axes.margin(of, T),
        "held at 800 Hz": axes.margin(of, 1 / bench.printed("Y-7.rate_lqg")),
        "sampled at 1 kHz": axes.sampled_margin(of, T),
    }
    crossover, margin = printed["crossover"], printed["margin"]
    factor = 1 / axes.gain_at(of, crossover.value)
    raised = axes.margin(replace(of, gain=factor * of.gain)).phase
    delay = (raised - margin.value) / 360 / crossover.value
    figures = [
        *((f"crossover, {name}", m.crossover, "Hz") for name, m in cases.items()),
        *((f"phase margin, {name}", m.phase, "degrees") for name, m in cases.items()),
        ("factor on the gain that makes the printed crossover", factor, "1"),
        ("phase margin then, continuous", raised, "degrees"),
        ("delay that then makes the printed margin", 1e3 * delay, "ms"),
    ]
    return Outcome(figures, any(crossover.agrees(m.crossover) and margin.agrees(m.phase) for m in cases.values()))


@recomputes("Y-9", *X, "Y-7.rate")
def settling(bench: Bench, printed: Published) -> Outcome:
    """Recompute rise and settling of steps in x and y."""
    steps = _steps_of_x(bench)
    figures = of_steps(steps, rise="rise", settled="last time outside 2 %")
    return Outcome(figures, all(in_bounds(s, printed) for s in steps.values()))


@recomputes("Y-9b", *X, "Y-7.rate")
def overshoot(bench: Bench, printed: Published) -> Outcome:
    """Recompute the overshoot of steps in x and y."""
    steps = _steps_of_x(bench)
    return Outcome(of_steps(steps, overshoot="overshoot"), any(overshoots(s, printed) for s in steps.values()))


@recomputes("Y-32", *(name for source in VERTICAL.values() for name in source.names()), "Y-7.rate")
def controllers(bench: Bench, printed: Published) -> Outcome:
    """Recompute order, integrators and stability of all loops, and the margins of the vertical ones."""
    T, every = _period(bench), {name: axis(bench, name) for name in (*HORIZONTAL, *VERTICAL)}
    held = {name: axes.margin(each, T) for name, each in every.items()}
    delayed = [axes.margin(each, T, T).stable for each in every.values()]
    figures = [
        ("loops stable, held at 1 kHz", float(sum(m.stable for m in held.values())), "1"),
        ("loops stable, held at 1 kHz and a sample late", float(sum(delayed)), "1"),
    ]
    for name in VERTICAL:
        free = axes.margin(every[name])
        figures += [(f"crossover, {name}", free.crossover, "Hz"), (f"phase margin, {name}", free.phase, "degrees")]
        figures.append((f"delay margin after the hold, {name}", 1e3 * held[name].delay, "ms"))
    order = printed["order"].value
    as_printed = (held[n].stable and len(a.poles) == order and a.poles.count(0.0) == 1 for n, a in every.items())
    return Outcome(figures, all(as_printed))


@recomputes("Y-33", *PHI, *THETA, "Y-7.rate")
def axis_of_figure_8c(bench: Bench, printed: Published) -> Outcome:
    """Recompute the step of the axis that the text names, and of the one that the caption names."""
    steps = {name: axes.sampled_step(axis(bench, name), _period(bench)) for name in ("theta", "phi")}
    figures = of_steps(steps, rise="rise", settled="last time outside 2 %", overshoot="overshoot")
    return Outcome(figures, *(in_bounds(s, bench.published["Y-9"]) for s in steps.values()))


def axis(bench: Bench, name: str) -> Axis:
    """Return an axis, by the printed time constants of (21), (22) or the zeros and poles of (23)-(25)."""
    source = (HORIZONTAL | VERTICAL)[name]
    gain, lead, lag, reset = (bench.printed(f"{source.prefix}{n}") for n in ("gain", "lead", "lag", "reset"))
    if name in HORIZONTAL:
        gain, lead, lag, reset = gain * lead * reset / lag, 1 / lead, 1 / lag, 1 / reset
    spring = bench.value(source.spring) if source.spring else 0.0
    return Axis(bench.value(source.inertia), spring, gain, (-lead, -reset), (-lag, 0.0))


def of_steps(steps: Mapping[str, Step], **labels: str) -> list[tuple[str, float, str]]:
    """Return figures of steps by name: those fields of `Step` that have a label."""
    return [
        (f"{label}, {name}", SCALES[field][0] * getattr(s, field), SCALES[field][1])
        for field, label in labels.items()
        for name, s in steps.items()
    ]


def in_bounds(step: Step, bounds: Published) -> bool:
    """Tell whether a step keeps the bounds of Y-9."""
    return 1e3 * step.rise < bounds["rise"].value and 1e3 * step.settled < bounds["settling"].value


def overshoots(step: Step, printed: Published) -> bool:
    """Tell whether a step overshoots as Y-9b says."""
    return abs(step.overshoot / printed["overshoot"].value - 1) <= OVERSHOOT


def _steps_of_x(bench: Bench) -> dict[str, Step]:
    x = axis(bench, "x")
    return {"continuous": axes.step(x), "sampled at 1 kHz": axes.sampled_step(x, _period(bench))}


def _period(bench: Bench) -> float:
    return 1 / (KHZ * bench.printed("Y-7.rate"))
