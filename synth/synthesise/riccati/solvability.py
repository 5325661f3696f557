"""Existence of the stabilising solution of a Riccati equation, and the modes that the optimal loop mirrors.

The solution exists only if (A, B) is stabilisable and each mode on the stability boundary is observable in the cost:
there are no v != 0 and w with

    A v + B w = s v,     Q v + N w = 0,     N'v + R w = 0,     Re s = 0, or |s| = 1 in discrete time

(Popov, Belevitch, Hautus). Where R is regular, v is an eigenvector of A - B R^-1 N' in the null space of
Q - N R^-1 N'. For a positive semidefinite cost this is sufficient (Lancaster, Rodman 1995, chapters 16 and 17); for an
indefinite one the Hamiltonian matrix may have other eigenvalues on the boundary. A mode beyond the boundary that is not
observable in the cost is mirrored: the optimal loop has the pole -conj(s), or 1 / conj(s).

A stable loop with a certified X proves all of this. Where the loop decays slowly, or none is found, the modes are
searched, and the error names the mode.
"""

from collections.abc import Sequence

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from synth import show
from synth.analyse.structure import staircase, structure
from synth.errors import ModelError
from synth.statespace import Array, Complex, StateSpace
from synth.synthesise.riccati import weights
from synth.synthesise.riccati.equation import Equation, decays
from synth.timing import Continuous, Time

MARGIN = 1e-7  # of the fastest pole: a slower decay may be the rounding error of none
DAMPING = 1e-6  # of a pole: likewise
BOUNDARY = 1e-10  # of the fastest mode: within it a mode, or the mean of a cluster, lies on the boundary
UNSTABLE_DISTANCE = 1e-9  # of the fastest mode: a mode this far beyond the boundary is unstable for any rounding
CLUSTER = 1e-5  # of the fastest mode: equal modes scatter by less
MIRRORED = 0.02  # of a mode: a pole within this distance of its mirror image may be that image
ISOLATION_DISTANCE = 1e-3  # of a mode: the least distance of an isolated mode from all others
UNIT = 2.0**-50  # times n: the distance from the unit circle that rounding of entries near 1 can cause
WEIGHTED_THRESHOLD = 1e-10  # of the largest eigenvalue of Q


def marginal_poles(model: StateSpace, equation: Equation, poles: Complex, rigid: bool) -> Complex:
    """Return the poles that decay, but by less than the rounding of the model; usually there are none.

    `poles` (n,) are those of ball arithmetic. Modes are searched where a pole decays slowly, or where the equation is
    `rigid`, i.e. ill-conditioned.

    Raises ModelError unless all poles of the loop decay, in discrete time beyond rounding.
    """
    size = float(np.abs(poles).max())
    if not decays(poles, equation.continuous):
        slowest = poles[np.argmax(poles.real if equation.continuous else np.abs(poles))]
        raise ModelError(
            f"the Riccati equation's solution leaves the pole {slowest:.4g}, which does not decay: "
            "scale the weights and the states to similar size"
        )
    rates = -poles.real if equation.continuous else 1 - np.abs(poles)
    least = np.maximum(MARGIN * (size or 1.0), DAMPING * np.abs(poles)) if equation.continuous else MARGIN
    searched = rigid or (rates < least).any()
    if not searched or (error := hidden_mode_error(model, equation)) is None:
        return np.zeros(0, dtype=np.complex128)
    if not equation.continuous and rates.min() < UNIT * len(poles):
        raise error
    return poles[rates <= 2 * rates.min()]


def hidden_mode_error(model: StateSpace, stated: Equation) -> ModelError | None:
    """Return the ModelError of `require_detectable_boundary` for a mode on the stability boundary, None without one.

    Raises ModelError for an uncontrollable mode beyond the boundary.
    """
    try:
        require_detectable_boundary(model, stated)
    except ModelError as error:
        modes = structure.uncontrollable_modes(model.A, model.B, model.states, model.time)
        fastest = float(np.abs(np.linalg.eigvals(model.A)).max())
        beyond = (m.value.real / (fastest or 1.0) if stated.continuous else abs(m.value) - 1 for m in modes)
        if any(by > UNSTABLE_DISTANCE for by in beyond):
            raise
        return error
    return None


def require_detectable_boundary(model: StateSpace, stated: Equation) -> None:
    """Raise ModelError naming a mode that is not stabilisable, or is on the boundary and not observable in the cost."""
    structure.require_stabilisable(model.A, model.B, model.states, model.inputs, model.time)
    if not _is_regular(stated):
        zeros, rank = _invisible_modes(model, stated)
        if rank < len(model.inputs):
            raise _singular_weight_error(model)
        for s in zeros[_near_boundary(zeros, float(np.abs(zeros).max(initial=0.0)), stated.continuous)]:
            raise ModelError(
                f"the Riccati equation has no stabilising solution: the cost does not see the mode {_mode_text(s)}, "
                "which lies on the stability boundary, with a suitable input: weight that input, or the states that it "
                "moves"
            )
        return
    for mode in unobservable_boundary_modes(*_without_cross_weight(stated), model.states, model.time):
        who = ", ".join(mode.states)
        raise ModelError(
            f"the Riccati equation has no stabilising solution: (Q, A) does not show the mode {_mode_text(mode.value)} "
            f"in {who}, |Q v| = {mode.measure:.0e}, which lies on the stability boundary and stays there in the "
            f"optimal loop: weight {who}, or take it out of the model"
        )


def unobservable_boundary_modes(A: Array, Q: Array, states: Sequence[str], time: Time) -> list[structure.Mode]:
    """Return the modes of A (n, n) on the stability boundary that are not observable through Q (n, n)."""
    hidden = _unobservable_modes(A, Q, states)
    fastest = float(np.abs(np.linalg.eigvals(A)).max(initial=0.0))
    near = _near_boundary(np.array([m.value for m in hidden]), fastest, isinstance(time, Continuous))
    return [mode for mode, on in zip(hidden, near, strict=True) if on]


def _unobservable_modes(A: Array, Q: Array, states: Sequence[str]) -> tuple[structure.Mode, ...]:
    """Return the modes of A (n, n) that are not observable through Q (n, n)."""
    part = staircase.scaled(A.T, Q.T)
    return structure.named_modes(staircase.uncontrollable_modes(part), part.B.T, part.rate, states)


def mirrored_modes(model: StateSpace, stated: Equation, scaled: Equation, poles: Complex) -> tuple[complex, ...]:
    """Return the modes beyond the stability boundary that are not observable in the cost; `poles` (n,) of the loop."""
    if not _is_regular(stated):
        zeros, _ = _invisible_modes(model, stated)
        beyond = zeros.real > 0 if stated.continuous else np.abs(zeros) > 1
        return tuple(complex(s) for s in zeros[beyond])
    if _certainly_detectable(scaled, poles):
        return ()
    hidden = (mode.value for mode in _unobservable_modes(*_without_cross_weight(stated), model.states))
    return tuple(s for s in hidden if (s.real > 0 if stated.continuous else abs(s) > 1))


def require_clear_boundary(scaled: Equation) -> None:
    """Raise ModelError when the Hamiltonian matrix of an indefinite cost has eigenvalues on the stability boundary."""
    s = _pencil_eigenvalues(scaled)
    off = s.real / (float(np.abs(s).max(initial=0.0)) or 1.0) if scaled.continuous else np.abs(s) - 1
    on = s[np.abs(off) <= BOUNDARY]
    if len(on):
        listed = ", ".join(_mode_text(v) for v in on[:4])
        least = weights.lowest_eigenvalue(weights.joint_weight(scaled.Q, scaled.R, scaled.N))
        raise ModelError(
            f"the Riccati equation has no stabilising solution: the cost is indefinite, with the least eigenvalue "
            f"{least:.3g} (balanced), and has no lower bound, as its Hamiltonian matrix has the "
            f"eigenvalues {listed} on the stability boundary: raise Q"
        )


def least_stabilisable_mode(model: StateSpace, scaled: Equation) -> str:
    """Describe the mode that does not decay and is nearest to an uncontrollable one.

    The distance is the least singular value of [A - s I, B], balanced: a change of A and B of that size makes the mode
    uncontrollable.
    """
    s = np.linalg.eigvals(scaled.A).astype(np.complex128)
    unstable = s[s.real >= 0 if scaled.continuous else np.abs(s) >= 1]
    if not unstable.size:
        return "all modes decay by themselves;"
    one = np.eye(len(s))
    split = [np.linalg.svd(np.hstack([scaled.A - v * one, scaled.B]))[:2] for v in unstable]
    k = min(range(len(split)), key=lambda i: float(split[i][1][-1]))
    U, sigma = split[k]
    who = structure.direction_text(structure.direction(U[:, -1].conj(), model.states))
    distance = float(sigma[-1] / sigma[0])
    return (
        f"mode {unstable[k]:.4g} in {who} is the least controllable: a change by {distance:.0e} of A and B "
        "makes it uncontrollable;"
    )


def require_unique_gain(model: StateSpace, weight: Array) -> None:
    """Raise ModelError when R, or S = R + B'XB, as `weight` (m, m) is singular."""
    if not weights.is_regular(weight):
        raise _singular_weight_error(model)


def _singular_weight_error(model: StateSpace) -> ModelError:
    return ModelError(
        f"R + B'XB is singular: the cost does not distinguish the inputs {', '.join(model.inputs)} and many "
        "gains are optimal; weight each of them in R"
    )


def _near_boundary(s: Complex, fastest: float, continuous: bool) -> NDArray[np.bool_]:
    """Tell for each mode whether it, or the mean of its cluster, lies on the stability boundary."""
    if not len(s):
        return np.zeros(0, dtype=np.bool_)
    unit = (fastest or 1.0) if continuous else 1.0
    near = np.abs(s[:, None] - s) <= CLUSTER * unit
    both = np.array([s, near @ s / near.sum(axis=1)])
    off = both.real if continuous else np.abs(both) - 1
    return np.asarray((np.abs(off) <= BOUNDARY * unit).any(axis=0))


def _is_regular(stated: Equation) -> bool:
    """Tell whether A - B R^-1 N' is defined."""
    return stated.continuous or weights.is_regular(stated.R)


def _without_cross_weight(stated: Equation) -> tuple[Array, Array]:
    """Return A - B R^-1 N' and Q - N R^-1 N'."""
    shift = np.linalg.solve(stated.R, stated.N.T)
    return stated.A - stated.B @ shift, stated.Q - stated.N @ shift


def _invisible_modes(model: StateSpace, stated: Equation) -> tuple[Complex, int]:
    """Return the modes s, with an input w, that are not observable in the cost: the zeros of A, B, [Q; N'], [N; R].

    Also returns the normal rank of their transfer matrix.
    """
    joint = weights.joint_weight(stated.Q, stated.R, stated.N)
    n, names = len(model.states), tuple(f"y{k}" for k in range(len(joint)))
    seen = StateSpace(model.A, model.B, joint[:, :n], joint[:, n:], model.states, model.inputs, names, model.time)
    zeros = structure.transmission_zeros(seen)
    unseen = np.array([m.value for m in zeros.unobservable], dtype=np.complex128)
    return np.concatenate([zeros.values, unseen]), zeros.rank


def _pencil_eigenvalues(e: Equation) -> Complex:
    """Return the eigenvalues of the Hamiltonian matrix, or in discrete time of the symplectic pencil."""
    if e.continuous:
        A, Q = _without_cross_weight(e)
        G = e.B @ np.linalg.solve(e.R, e.B.T)
        return np.linalg.eigvals(np.block([[A, -G], [-Q, -A.T]])).astype(np.complex128)
    none, one = np.zeros_like, np.eye(len(e.A))
    F = np.block([[e.A, none(e.A), e.B], [-e.Q, one, -e.N], [e.N.T, none(e.B.T), e.R]])
    E = np.block([[one, none(e.A), none(e.B)], [none(e.A), e.A.T, none(e.B)], [none(e.B.T), -e.B.T, none(e.R)]])
    values = scipy.linalg.eigvals(F, E)
    return np.asarray(values[np.isfinite(values)], dtype=np.complex128)


def _certainly_detectable(scaled: Equation, poles: Complex) -> bool:
    """Tell whether each mode that does not decay is certainly observable in the cost."""
    joint = weights.joint_weight(scaled.Q, scaled.R, scaled.N) if scaled.N.any() else scaled.Q
    if weights.is_above(joint, weights.ROUNDING):
        return True
    A, Q = _without_cross_weight(scaled)
    if not _may_be_mirrored(np.linalg.eigvals(A).astype(np.complex128), poles, scaled.continuous).any():
        return True
    s, V = np.linalg.eig(A)
    i = np.flatnonzero(_may_be_mirrored(s, poles, scaled.continuous))
    distance = np.abs(s[i, None] - s) + np.where(i[:, None] == np.arange(len(s)), np.inf, 0)
    cost = np.einsum("ji,jk,ki->i", V[:, i].conj(), Q, V[:, i]).real
    return bool(
        (distance.min(axis=1) > ISOLATION_DISTANCE * np.abs(s[i])).all()
        and (np.abs(cost) > WEIGHTED_THRESHOLD * np.linalg.norm(Q)).all()
    )


def _may_be_mirrored(s: Complex, poles: Complex, continuous: bool) -> NDArray[np.bool_]:
    """Tell for each mode whether it does not decay and has a mirror image near a pole."""
    unstable = s.real >= 0 if continuous else np.abs(s) >= 1
    mirror = -s.conj() if continuous else 1 / np.where(unstable, s, 1.0).conj()
    near = np.abs(poles - mirror[:, None]).min(axis=1) <= MIRRORED * np.abs(mirror)
    return np.asarray(unstable & near)


def _mode_text(s: complex) -> str:
    return show.number(s.real, 4) if abs(s.imag) < 1e-9 * abs(s) else f"{s.real:.4g}{s.imag:+.4g}i"
