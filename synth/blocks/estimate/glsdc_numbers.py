"""Numbers of a least-squares estimator that its C names, with units: scale, pivots, limits, thresholds, starts.

The letters are those of `glsdc_solution`, `glsdc_integrity` and `glsdc_search`. A number that a signal's range or a
constant of geometry has already, such as pi, has no name here.
"""

from collections.abc import Iterator, Sequence
from math import pi, sqrt

import numpy as np

from synth.block import Constant
from synth.blocks.estimate import glsdc_exclusion, glsdc_integrity, glsdc_monitor, glsdc_solution
from synth.blocks.estimate.glsdc_jacobian import Model
from synth.blocks.estimate.glsdc_model import Unknown
from synth.blocks.estimate.glsdc_monitor import Monitor
from synth.blocks.estimate.glsdc_search import Search
from synth.blocks.estimate.glsdc_solution import DYNAMIC_RANGE, Iteration
from synth.blocks.guard import range_numbers
from synth.blocks.guard.range_numbers import limit
from synth.signals import product_unit, quotient_unit


def of_solution(of: Model, iteration: Iteration) -> list[Constant]:
    """Return the numbers of the scale, of the corrections and of the factors L D L'."""
    s, unit = of.scale, _scale_unit(of)
    square = product_unit(unit, unit)
    tolerance = f"({iteration.convergence:g} channel_sigma)^2: a smaller predicted decrease has converged"
    numbers = [limit("decrease_tolerance", iteration.convergence**2 * s**2, square, tolerance)]
    if s != 1:
        numbers += [
            Constant("channel_sigma", s, unit, "deviation of a channel, from R"),
            Constant("channel_variance", s**2, square, "variance of a channel, from R"),
            Constant("inverse_channel_variance", 1 / s**2, quotient_unit("1", square), "1 / variance"),
        ]
    if iteration.descent_check:
        numbers += [
            Constant("slack", glsdc_solution.SLACK * s**2, square, "rise of the cost that counts as none: rounding"),
            Constant("rounding_factor", 1 + glsdc_solution.ROUNDING, "1", "of a cost that counts as no higher"),
        ]
    for p in of.phases:
        numbers += [
            limit(f"largest_phase_{p.name}", p.largest, "rad", "largest size of a phase"),
            limit(f"largest_change_{p.name}", p.change, "rad", "largest change of a phase in a sample"),
        ]
    return [*numbers, *_of_unknowns(of, square), *_of_factors(of)]


def _of_unknowns(of: Model, square: str) -> Iterator[Constant]:
    columns = zip(
        of.unknowns, of.floors, of.weak_from, of.prior_weights, glsdc_solution.forward_bounds(of), strict=True
    )
    for u, floor, weak, weight, forward in columns:
        n, unit = u.name, u.signal.unit
        information = quotient_unit(square, product_unit(unit, unit))
        inverse, largest = quotient_unit("1", information), _quantity(u.largest_deviation, unit)
        resolved = f"a larger N_ii is not resolved: {DYNAMIC_RANGE:g}^2 times the least pivot"
        yield limit(
            f"least_pivot_{n}", floor, information, f"channel_variance / sigma^2, sigma = {largest}, the largest"
        )
        yield limit(f"largest_information_{n}", DYNAMIC_RANGE**2 * floor, information, resolved)
        yield limit(
            f"weak_from_{n}",
            weak,
            inverse,
            f"sigma^2 / channel_variance, sigma = {largest}, less 1e-05 of it for rounding",
        )
        yield limit(f"largest_deviation_{n}", u.largest_deviation, unit, "largest sigma that is reported")
        yield limit(f"largest_step_{n}", u.step, unit, "correction of a sample at most")
        if u.velocity_gain:
            yield limit(f"largest_motion_{n}", u.step, unit, "predicted change a sample at most")
        yield limit(f"largest_z_{n}", forward, quotient_unit(square, unit), "bound of L^-1 H'e, which never acts")
        if weight:
            prior = _quantity(u.prior, unit)
            yield Constant(
                f"prior_weight_{n}", weight, information, f"channel_variance / sigma^2, sigma = {prior} of the prior"
            )
        if u.signal.high != pi:
            yield from range_numbers.ends(u.signal)
            yield from [_width(u)] if u.periodic else []


def _width(of: Unknown) -> Constant:
    return Constant(f"width_{of.name}", of.width, of.signal.unit, "width of its range")


def _of_factors(of: Model) -> Iterator[Constant]:
    """Return the bounds of L below its diagonal."""
    for i, (row, of_row) in enumerate(zip(of.unknowns, of.floors, strict=True)):
        for column, of_column in zip(of.unknowns[:i], of.floors[:i], strict=True):
            unit = quotient_unit(column.signal.unit, row.signal.unit)
            yield limit(
                f"largest_L_{row.name}_{column.name}",
                DYNAMIC_RANGE * sqrt(of_row / of_column),
                unit,
                f"bound of L in row {row.name}",
            )


def of_monitor(of: Monitor) -> list[Constant]:
    """Return the thresholds of the test and of the hypotheses, and the limits of the protection levels."""
    t, s, unit, risk = of.thresholds, of.model.scale, _scale_unit(of.model), f"risk {of.integrity.risk:g}"
    square, least = product_unit(unit, unit), glsdc_integrity.DETECTABLE
    freedom = len(of.model.channels) - len(of.model.unknowns) + sum(p > 0 for p in of.model.prior_weights)
    test = f"chi-square of {freedom} degrees of freedom, false alarm {of.integrity.false_alarm:g}"
    undetected = f"channel_sigma times the root of the noncentrality: a fault that passes the test with {risk}"
    gain = "1 / separability, less 1e-05 of it, of a fault that is detectable"
    numbers = [
        Constant("test_threshold", t.test, "1", test),
        limit("test_cost", t.test * s**2, square, "test_threshold times channel_variance"),
        Constant("level_sigmas", t.deviations, "1", f"sigmas of a protection level, half of {risk}"),
        Constant("undetected", sqrt(t.noncentrality) * s, unit, undetected),
        limit("least_separability", least, "1", "below it a fault looks like a motion"),
        limit("largest_gain", (1 - glsdc_integrity.ROUNDING) / least, "1", gain),
        limit("largest_mixing", sqrt(1 / least), "1", "bound of the factors of a group's separability"),
    ]
    if of.integrity.exclude:
        projection = glsdc_exclusion.largest_projection(of.model)
        numbers += [
            Constant("level_noise", t.deviations * s, unit, "level_sigmas times channel_sigma"),
            Constant("cancellation", glsdc_integrity.ROUNDING, "1", "relative error of a cost by rounding"),
            limit("largest_projection", projection, unit, "bound of |x_j'g|, which never acts"),
        ]
    for size, threshold in sorted({len(g): T for g, T in zip(of.groups, of.hypothesis, strict=True)}.items()):
        if np.isfinite(threshold):
            of_size = "" if len(set(of.hypothesis)) == 1 else f"_of_{size}"
            about = f"chi-square of {freedom - size} degrees of freedom, half of {risk}: without the excluded group"
            cost = "hypothesis_threshold times channel_variance"
            numbers += [
                Constant(f"hypothesis_threshold{of_size}", threshold, "1", about),
                Constant(f"hypothesis_cost{of_size}", threshold * s**2, square, cost),
            ]
    return [*numbers, *_of_limits(of)]


def _of_limits(of: Monitor) -> Iterator[Constant]:
    share = of.integrity.excluded_limits
    for u in of.model.unknowns:
        if most := of.integrity.limits.get(u.name):
            n, unit, times = u.name, u.signal.unit, glsdc_monitor.LEVEL_RANGE
            largest = f"{times:g} times the limit: level that is reported at most"
            yield limit(f"limit_{n}", most, unit, "of a valid protection level")
            yield limit(f"largest_level_{n}", times * most, unit, largest)
            if share < 1:
                about = f"{share:g} times the limit, while a group is excluded"
                yield limit(f"excluded_limit_{n}", glsdc_monitor.excluded_limit(of, n), unit, about)


def of_search(of: Search, unknowns: Sequence[Unknown]) -> list[Constant]:
    """Return the numbers of a search: its counts, the increments of a start and what counts as one solution."""
    increments = of.increments(unknowns)
    numbers = of.counts()
    for u in (u for u in unknowns if u.name in increments):
        n, unit = u.name, u.signal.unit
        numbers += [
            *([] if u.periodic or u.signal.high == pi else [_width(u)]),
            Constant(f"increment_{n}", increments[n], unit, "from one start to the next: Roberts' sequence"),
            limit(f"agreement_{n}", of.agreement[n], unit, "solutions closer than this count as one"),
        ]
    return numbers


def _scale_unit(of: Model) -> str:
    """Return the unit of s: that of the channels, or 1 after whitening by R."""
    return of.channels[0].unit if np.array_equal(of.whitening, np.eye(len(of.channels))) else "1"


def _quantity(value: float, unit: str) -> str:
    return f"{value:g}" if unit == "1" else f"{value:g} {unit}"
