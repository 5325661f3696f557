"""Gauss-Newton corrections without an excluded group of channels, by a rank update of the factors of all channels.

    N = H'H + P = L D L'  of all channels at the prediction, once a sample;   x_j, gain_j = 1/s_j of `glsdc_integrity`
    N_k = N - H_k'H_k,    N_k^-1 = N^-1 + sum over j of group k of x_j gain_j x_j'        (Woodbury)

    first correction    q - x_j u_j gain_j        from the solution q of all channels, with their scores u_j
    later ones          N_k^-1 g,                 g = H'e - P (o + d) without the residuals of the group

The hypotheses that monitor the solution have computed x_j, gain_j and u_j anyway: there is no second factorisation.
Each displacement is limited by itself.

Source: Golub, Van Loan, "Matrix Computations", section 2.1.4 (Sherman-Morrison-Woodbury formula).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import sqrt

import casadi as ca

from synth.block import clip
from synth.blocks.estimate import glsdc, glsdc_integrity, glsdc_linearisation, glsdc_solution
from synth.blocks.estimate.glsdc import LdlFactors, LdlNormalEquations, LimitStep, Solution, Trial, Vector, dot, total
from synth.blocks.estimate.glsdc_integrity import Full, Hypotheses
from synth.blocks.estimate.glsdc_jacobian import Model
from synth.blocks.estimate.glsdc_linearisation import Linearisation
from synth.blocks.estimate.glsdc_solution import DYNAMIC_RANGE, Iteration, Normal, Problem
from synth.signals import Signal


@dataclass(frozen=True, eq=False)
class Separation:
    """The hypotheses about a trial, the solution with all channels and its cost c s^2, and whether N is in range."""

    faults: Hypotheses
    full: Full
    cost: ca.SX
    in_range: ca.SX


@dataclass(frozen=True, eq=False)
class Removal:
    """x_j (n,) and gain_j of the excluded group; without one the gains are 0."""

    moves: Sequence[Vector]
    gains: Vector


@dataclass(frozen=True, eq=False)
class Reduced(Normal):
    """Normal equations of a trial without the excluded group, on the factors of all channels.

    `projections` are x_j'g, or -u_j at the first trial, whose `forward` is of all channels; `dropped` are then the
    squared residuals of the group, else 0.
    """

    removal: Removal
    projections: Vector
    dropped: ca.SX

    @property
    def decrease(self) -> ca.SX:
        """g' N_k^-1 g."""
        added = total(gain * p**2 for gain, p in zip(self.removal.gains, self.projections, strict=True))
        return super().decrease - self.dropped + added

    @property
    def variances(self) -> list[ca.SX]:
        """The diagonal of N_k^-1."""
        gains, moves = self.removal.gains, self.removal.moves
        added = [total(gain * x[i] ** 2 for gain, x in zip(gains, moves, strict=True)) for i in range(len(self.pulls))]
        return [v + a for v, a in zip(super().variances, added, strict=True)]

    def solve(self, choose: LimitStep, scale: float = 1.0) -> list[ca.SX]:
        """Return the unknowns after the step N_k^-1 g times `scale`, each limited by itself."""
        scaled = [gain * p for gain, p in zip(self.removal.gains, self.projections, strict=True)]
        steps = super().solve(lambda i, step: (step, step))
        added = [total(x[i] * v for x, v in zip(self.removal.moves, scaled, strict=True)) for i in range(len(steps))]
        return [choose(i, scale * (step + a))[0] for i, (step, a) in enumerate(zip(steps, added, strict=True))]


def solve(
    of: Problem,
    iteration: Iteration,
    groups: Sequence[Sequence[int]],
    excluded: ca.SX,
    axes: Sequence[Mapping[int, ca.SX]],
) -> tuple[Solution[Reduced], Separation]:
    """Return the solution of a sample with the Jacobian of the prediction, and the hypotheses about this.

    `excluded` is the number of the group that the weights leave out, 0 for none; `axes` are the unit vectors along
    which the channels of a group act.
    """
    of_all, begin = replace(of, weights=None), linearise(of, [ca.SX(0)] * len(of.offsets))
    factors = glsdc_solution.factorise(of.model, begin.rows, begin.rows)
    whole = glsdc_solution.trial(of_all, [ca.SX(0)] * len(of.offsets), begin, factors)
    separation = _separation(of.model, groups, *factors, whole, replace(begin, directions=axes))
    removal, scores = _removal(groups, separation, excluded)
    most = largest_projection(of.model)
    bound = Signal("projection", "1", -most, most)

    def trial(i: int, at: Vector) -> Trial[Reduced]:
        linear = replace(begin, residuals=linearise(of, at).residuals) if i else begin
        one = glsdc_solution.trial(of, at, linear, factors)
        used = glsdc_solution.weighted(of, linear.residuals)
        if i:
            gradient = glsdc_solution.gradient_of(linear.rows, used, one.normal.pulls)
            projections = [clip(dot(x, gradient), bound) for x in removal.moves]
            normal = _without_group(one.normal, removal, projections, ca.SX(0))
        else:
            dropped = whole.squares - one.squares
            normal = _without_group(whole.normal, removal, [-u for u in scores], dropped)
        return Trial(at, one.residuals, one.squares, one.cost, normal)

    return glsdc_solution.iterate(of.model, iteration, trial), separation


def largest_projection(of: Model) -> float:
    """Return the bound of |x_j'g|: at most |e|, and what the factors of its group add; it keeps the square finite."""
    return (1 + 1 / sqrt(glsdc_integrity.DETECTABLE)) * glsdc_solution.residual_bound(of)


def linearise(of: Problem, at: Vector) -> Linearisation:
    """Return the linearisation of a problem at a displacement."""
    return glsdc_linearisation.linearise(of.model, of.prediction, at)


def _without_group(of: Normal, removal: Removal, projections: Vector, dropped: ca.SX) -> Reduced:
    return Reduced(of.factors, of.forward, of.linear, of.pulls, of.in_range, removal, projections, dropped)


def _removal(groups: Sequence[Sequence[int]], of: Separation, excluded: ca.SX) -> tuple[Removal, list[ca.SX]]:
    """Return what is removed, and the scores u_j of the excluded group."""

    def member(values: Vector, j: int) -> ca.SX:
        return choose(excluded, [values[group[j]] if j < len(group) else ca.SX(0) for group in groups])

    sizes, moves = range(max(map(len, groups))), of.faults.moves
    columns = [[member([x[i] for x in moves], j) for i in range(len(moves[0]))] for j in sizes]
    gains, scores = ([member(values, j) for j in sizes] for values in (of.faults.gains, of.full.scores))
    return Removal(columns, [ca.if_else(excluded < 1, 0, gain) for gain in gains]), scores


def choose(number: ca.SX, values: Vector) -> ca.SX:
    """Return the value of a number from 1 on, the first one of 0, by halving: both outcomes of a comparison occur."""

    def between(low: int, high: int) -> ca.SX:
        if high - low == 1:
            return values[low - 1]
        middle = (low + high) // 2
        return ca.if_else(number < middle, between(low, middle), between(middle, high))

    return between(1, len(values) + 1)


def separate(of: Model, groups: Sequence[Sequence[int]], about: Trial[Normal], linear: Linearisation) -> Separation:
    """Return the hypotheses about a trial; `linear` has the unit vectors along which the channels of a group act."""
    factors, in_range = glsdc_solution.factorise(of, about.normal.linear.rows, about.normal.linear.rows)
    return _separation(of, groups, factors, in_range, about, linear)


def _separation(
    of: Model,
    groups: Sequence[Sequence[int]],
    factors: LdlFactors,
    in_range: ca.SX,
    about: Trial[Normal],
    linear: Linearisation,
) -> Separation:
    faults = glsdc_integrity.hypotheses(groups, factors, linear, of.floors, DYNAMIC_RANGE)
    normal, e = about.normal, about.normal.linear.residuals
    gradient = glsdc_solution.gradient_of(normal.linear.rows, e, normal.pulls)
    forward = glsdc.substitute_forward(factors, gradient, glsdc_solution.forward_bounds(of))
    all_channels = LdlNormalEquations(factors, forward)
    step = _limit_step(of, all_channels.step)
    scores = [
        glsdc_integrity.dot_sparse(w, e) - dot(slope, step)
        for w, slope in zip(linear.directions, faults.slopes, strict=True)
    ]
    cost = ca.fmax(dot(e, e) + about.cost - about.squares - all_channels.decrease, 0)
    full = Full(step, glsdc.variances(factors), glsdc_integrity.decorrelate(faults, scores))
    return Separation(faults, full, cost, in_range)


def _limit_step(of: Model, step: Vector) -> list[ca.SX]:
    if len(step) <= glsdc.UNLIMITED:
        return list(step)
    bounds = [glsdc_solution.residual_bound(of) / sqrt(f) for f in of.floors]
    return [clip(d, Signal("step", "1", -b, b)) for d, b in zip(step, bounds, strict=True)]
