"""Audit of the lead-lag loops: crossovers and margins, steps, the vertical axes; `audit_axes` says on which loop."""

from collections.abc import Iterable

from designs.planar_6dof_leadlag import audit_axes
from designs.planar_6dof_leadlag.audit_axes import Axis, Step
from designs.planar_6dof_leadlag.audit_bench import Bench
from synth.report.audit import Published, Row, judge, row

OVERSHOOT = 0.25  # relative: "around 20 %" is 15 to 25 %
KHZ = 1e3
INERTIA = {"Y-7": "M", "Y-8": "Izz", "z": "M", "theta": "Ixx", "psi": "Iyy"}
SPRING = {"z": "Kz", "theta": "K_theta", "psi": "K_psi"}


def crossover(bench: Bench, printed: Published) -> Row:
    """Y-7, Y-8: recompute crossover and phase margin of x and y, or of phi."""
    axis, T = horizontal(bench, printed.id), _period(bench)
    cases = {
        "continuous": audit_axes.margin(axis),
        "held at 1 kHz": audit_axes.margin(axis, T),
        "held at 800 Hz": audit_axes.margin(axis, 1 / bench.printed("Y-7.rate_lqg")),
        "sampled at 1 kHz": audit_axes.sampled_margin(axis, T),
    }
    figures = [(f"crossover, {name}", m.crossover, "Hz") for name, m in cases.items()]
    figures += [(f"phase margin, {name}", m.phase, "degrees") for name, m in cases.items()]
    factor = 1 / audit_axes.gain_at(axis, printed["crossover"].value)
    raised = audit_axes.margin(Axis(axis.inertia, axis.spring, factor * axis.gain, axis.zeros, axis.poles)).phase
    late = (raised - printed["margin"].value) / 360 / printed["crossover"].value
    figures.append(("factor on the gain that makes the printed crossover", factor, "1"))
    figures.append(("phase margin then, continuous", raised, "degrees"))
    figures.append(("delay that then makes the printed margin", 1e3 * late, "ms"))
    why = (
        "Rule: crossover and margin both within one unit of the last printed digit, continuous, held or sampled. "
        "Held is the continuous loop under the hold alone; sampled is exact, K by the prewarped rule; neither has a "
        "computation delay. No one slip makes both rows: the factors on gain or inertia that would lie on opposite "
        "sides of 1, and the delays that would are a fivefold apart, though one sampling serves all axes."
    )
    agree = any(printed["crossover"].agrees(m.crossover) and printed["margin"].agrees(m.phase) for m in cases.values())
    compared = (f"{printed.id}.crossover", f"{printed.id}.margin")  # they enter the last three figures
    depends = (*sources(printed.id), *compared, "Y-7.rate", "Y-7.rate_lqg")
    return row(printed, figures, judge(agree), why, depends)


def settling(bench: Bench, printed: Published) -> Row:
    """Y-9: recompute rise and settling of steps in x and y."""
    cases = _steps(bench)
    figures = [(f"rise, {n}", 1e3 * s.rise, "ms") for n, s in cases.items()]
    figures += [(f"last time outside 2 %, {n}", 1e3 * s.settled, "ms") for n, s in cases.items()]
    why = (
        "Rule: both bounds, for the continuous loop and for the one sampled at 1 kHz by Tustin's rule without delay, "
        "with ideal sensing. The sampled times are whole milliseconds. The integrator leaves no steady-state error."
    )
    agree = all(within(s, printed) for s in cases.values())
    return row(printed, figures, judge(agree), why, (*sources("Y-7"), "Y-7.rate"))


def overshoot(bench: Bench, printed: Published) -> Row:
    """Y-9b: recompute the overshoot of steps in x and y."""
    cases = _steps(bench)
    figures = [(f"overshoot, {n}", s.overshoot, "%") for n, s in cases.items()]
    why = (
        "Rule: within a quarter of the print, continuous or sampled at 1 kHz by Tustin's rule without delay, with "
        "ideal sensing. The measured step of 20 um carries a noise of 6 um rms (Y-34), which raises its greatest "
        "sample."
    )
    agree = any(around(s, printed) for s in cases.values())
    return row(printed, figures, judge(agree), why, (*sources("Y-7"), "Y-7.rate"))


def axis_of_figure_8c(bench: Bench, printed: Published) -> Row:
    """Y-33: recompute the step of the axis that the text names, and of the one that the caption names."""
    axes = {"theta": vertical(bench, "theta"), "phi": horizontal(bench, "Y-8")}
    steps = {name: audit_axes.sampled_step(axis, _period(bench)) for name, axis in axes.items()}
    figures = [(f"rise, {n}", 1e3 * s.rise, "ms") for n, s in steps.items()]
    figures += [(f"last time outside 2 %, {n}", 1e3 * s.settled, "ms") for n, s in steps.items()]
    why = (
        "Rule: the bounds of Y-9, sampled at 1 kHz by Tustin's rule without delay. theta, which the text names, takes "
        "twice as long to settle; phi, which the caption names, half as long."
    )
    figures += [(f"overshoot, {n}", s.overshoot, "%") for n, s in steps.items()]
    verdict = judge(*(within(s, bench.published["Y-9"]) for s in steps.values()))
    return row(printed, figures, verdict, why, _unique(("Y-8", "theta"), "Y-7.rate"))


def controllers(bench: Bench, printed: Published) -> Row:
    """Y-32: recompute order, integrators and stability of all loops, and the margins of the vertical ones."""
    T, tilting = _period(bench), {name: vertical(bench, name) for name in SPRING}
    axes = {name: horizontal(bench, name) for name in ("Y-7", "Y-8")} | tilting
    held = {name: audit_axes.margin(axis, T) for name, axis in axes.items()}
    late = [audit_axes.margin(axis, T, T).stable for axis in axes.values()]
    figures = [("loops stable, held at 1 kHz", float(sum(m.stable for m in held.values())), "1")]
    figures.append(("loops stable, held at 1 kHz and a sample late", float(sum(late)), "1"))
    for name, axis in tilting.items():
        free = audit_axes.margin(axis)
        figures += [(f"crossover, {name}", free.crossover, "Hz"), (f"phase margin, {name}", free.phase, "degrees")]
        figures.append((f"delay margin after the hold, {name}", 1e3 * held[name].delay, "ms"))
    why = (
        "Rule: each compensator has the printed order and one pole at 0, and each of the five loops is stable when "
        "held at 1 kHz, so that a constant force leaves no error. A sample of computation delay on top, of which the "
        "paper says nothing, psi does not bear."
    )
    agree = all(
        held[n].stable and len(a.poles) == printed["order"].value and a.poles.count(0.0) == 1 for n, a in axes.items()
    )
    return row(printed, figures, judge(agree), why, _unique(SPRING, "Y-7.rate"))


def horizontal(bench: Bench, name: str) -> Axis:
    """Return x and y (Y-7) or phi (Y-8), from the printed time constants. Source: (21), (22)."""
    gain, lead, lag, reset = (bench.printed(f"{name}.{n}") for n in ("gain", "lead", "lag", "reset"))
    return Axis(bench.value(INERTIA[name]), 0.0, gain * lead * reset / lag, (-1 / lead, -1 / reset), (-1 / lag, 0.0))


def vertical(bench: Bench, name: str) -> Axis:
    """Return z, theta or psi, from the printed zeros and poles. Source: (23)-(25)."""
    gain, lead, lag, reset = (bench.printed(f"Y-32.{name}_{n}") for n in ("gain", "lead", "lag", "reset"))
    return Axis(bench.value(INERTIA[name]), bench.value(SPRING[name]), gain, (-lead, -reset), (-lag, 0.0))


def sources(name: str) -> tuple[str, ...]:
    """Return what an axis follows from: its inertia, its spring and its printed compensator."""
    own = "Y-32." + name + "_" if name in SPRING else name + "."
    printed = (f"{own}{n}" for n in ("gain", "lead", "lag", "reset"))
    return (INERTIA[name], *((SPRING[name],) if name in SPRING else ()), *printed)


def within(found: Step, bounds: Published) -> bool:
    """Tell whether a step keeps the bounds of Y-9."""
    return 1e3 * found.rise < bounds["rise"].value and 1e3 * found.settled < bounds["settling"].value


def around(found: Step, wanted: Published) -> bool:
    """Tell whether a step overshoots as Y-9b says."""
    return abs(found.overshoot / wanted["overshoot"].value - 1) <= OVERSHOOT


def _steps(bench: Bench) -> dict[str, Step]:
    axis = horizontal(bench, "Y-7")
    return {"continuous": audit_axes.step(axis), "sampled at 1 kHz": audit_axes.sampled_step(axis, _period(bench))}


def _period(bench: Bench) -> float:
    return 1 / (KHZ * bench.printed("Y-7.rate"))


def _unique(axes: Iterable[str], *others: str) -> tuple[str, ...]:
    return tuple(dict.fromkeys([*(s for name in axes for s in sources(name)), *others]))
