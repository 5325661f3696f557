"""Whether a Riccati equation has a stabilising solution, and which modes its loop mirrors.

It has one only if (A, B) is stabilisable and the cost sees each mode on the stability boundary: no v != 0 and w with

    A v + B w = s v,     Q v + N w = 0,     N'v + R w = 0,     Re s = 0, or |s| = 1 in discrete time

(Popov, Belevitch, Hautus). Where R is regular, v is an eigenvector of A - B R^-1 N' that Q - N R^-1 N' maps to zero.
For a cost that is positive semidefinite this is enough (Lancaster, Rodman 1995, chapters 16 and 17); for an indefinite
one the Hamiltonian matrix may have other eigenvalues on the boundary. A mode beyond the boundary that the cost does not
see is mirrored: the optimal loop has the pole -conj(s), or 1 / conj(s).

A stable loop with a certified X proves all of it. Where the loop hardly decays, or none is found, the modes are
searched, and what is refused is named.
"""

from collections.abc import Callable, Sequence

import numpy as np
import scipy.linalg
from numpy.typing import NDArray

from synth import show
from synth.analyse import staircase, structure
from synth.errors import ModelError
from synth.statespace import Array, Complex, StateSpace
from synth.synthesise.feedback import weights
from synth.synthesise.riccati.equation import Equation, decays
from synth.timing import Continuous, Time

MARGIN = 1e-7  # of the fastest pole: what decays slower may be the rounding error of a mode that does not decay
DAMPING = 1e-6  # of a pole: what decays slower may be so, too
BOUNDARY = 1e-10  # of the fastest mode: a mode this near to the boundary, or the mean of a cluster, lies on it
BEYOND = 1e-9  # of the fastest mode: a mode this far beyond the boundary lies there whatever rounds
CLUSTER = 1e-5  # of the fastest mode: equal modes scatter by less
MIRRORED = 0.02  # of a mode: a pole nearer than this to its mirror image may be one
ALONE = 1e-3  # of a mode: others are farther from one that stands alone
UNIT = 2.0**-50  # times n: a pole nearer to the unit circle is that of A's rounding, as entries near 1 have it
SEEN = 1e-10  # of the largest eigenvalue of Q


def prove(
    model: StateSpace, stated: Equation, poles: Complex, rigid: bool, exact: Callable[[], Complex] | None
) -> Complex:
    """Return the poles that decay, but by less than the rounding of the model: none, mostly.

    Where a mode on the stability boundary is hidden within rounding, `exact` decides: it gives the poles in ball
    arithmetic or raises ModelError; it is None where that takes too long. Modes are searched where a pole hardly
    decays, or where X is so sensitive that Newton's linear equation is `rigid`.

    Raises ModelError unless the poles of the loop decay.
    """
    size = float(np.abs(poles).max())
    if stated.continuous:
        doubtful = -poles.real < np.maximum(MARGIN * (size or 1.0), DAMPING * np.abs(poles))
    else:
        doubtful = 1 - np.abs(poles) < MARGIN
    within = np.zeros(0, dtype=np.complex128)
    searched = doubtful.any() or (rigid and exact is not None)
    if searched and (error := found_by_search(model, stated)) is not None:
        poles = _decided(error, exact)
        rates = -poles.real if stated.continuous else 1 - np.abs(poles)
        if not stated.continuous and rates.min() < UNIT * len(poles):
            raise error
        within = poles[rates <= 2 * rates.min()]
    if not decays(poles, stated.continuous):
        slowest = poles[np.argmax(poles.real if stated.continuous else np.abs(poles))]
        raise ModelError(
            f"the Riccati equation's solution leaves the pole {slowest:.4g}, which does not decay: "
            "scale the weights and the states so that they are of like size"
        )
    return within


def _decided(error: ModelError, exact: Callable[[], Complex] | None) -> Complex:
    if exact is None:
        raise error
    try:
        return exact()
    except ModelError as reason:
        raise error from reason


def found_by_search(model: StateSpace, stated: Equation) -> ModelError | None:
    """Return what `search` raises for a mode that is hidden within rounding and lies on the stability boundary.

    Raises ModelError for one beyond the boundary that no input moves.
    """
    try:
        search(model, stated)
    except ModelError as error:
        modes = structure.unmoved(model.A, model.B, model.states, model.time)
        fastest = float(np.abs(np.linalg.eigvals(model.A)).max())
        beyond = (m.value.real / (fastest or 1.0) if stated.continuous else abs(m.value) - 1 for m in modes)
        if any(by > BEYOND for by in beyond):
            raise
        return error
    return None


def search(model: StateSpace, stated: Equation) -> None:
    """Raise ModelError naming a mode that makes the problem unsolvable, if there is one."""
    structure.require_stabilisable(model.A, model.B, model.states, model.inputs, model.time)
    if not _is_regular(stated):
        zeros, rank = _zeros(model, stated)
        if rank < len(model.inputs):
            raise _untold(model)
        for s in zeros[_near_boundary(zeros, float(np.abs(zeros).max(initial=0.0)), stated.continuous)]:
            raise ModelError(
                f"the Riccati equation has no stabilising solution: the cost does not see the mode {_text(s)}, which "
                "lies on the stability boundary, with a suitable input: weight that input, or the states that it moves"
            )
        return
    for mode in boundary_modes(*_shifted(stated), model.states, model.time):
        who = ", ".join(mode.states)
        raise ModelError(
            f"the Riccati equation has no stabilising solution: (Q, A) does not show the mode {_text(mode.value)} in "
            f"{who}, |Q v| = {mode.measure:.0e}, which lies on the stability boundary, so that the optimal loop "
            f"leaves it there: weight {who}, or take it out of the model"
        )


def boundary_modes(A: Array, Q: Array, states: Sequence[str], time: Time) -> list[structure.Mode]:
    """Return the modes of A (n, n) on the stability boundary that Q (n, n) does not show."""
    hidden = _hidden(A, Q, states)
    fastest = float(np.abs(np.linalg.eigvals(A)).max(initial=0.0))
    near = _near_boundary(np.array([m.value for m in hidden]), fastest, isinstance(time, Continuous))
    return [mode for mode, on in zip(hidden, near, strict=True) if on]


def _hidden(A: Array, Q: Array, states: Sequence[str]) -> tuple[structure.Mode, ...]:
    """Return the modes of A (n, n) that Q (n, n) does not show."""
    part = staircase.scaled(A.T, Q.T)
    return structure.named_modes(staircase.unreached(part), part.B.T, part.rate, states)


def mirrored(model: StateSpace, stated: Equation, scaled: Equation, poles: Complex) -> tuple[complex, ...]:
    """Return the modes beyond the stability boundary that the cost does not see, for a loop with these poles (n,)."""
    if not _is_regular(stated):
        zeros, _ = _zeros(model, stated)
        beyond = zeros.real > 0 if stated.continuous else np.abs(zeros) > 1
        return tuple(complex(s) for s in zeros[beyond])
    if _sees(scaled, poles):
        return ()
    hidden = (mode.value for mode in _hidden(*_shifted(stated), model.states))
    return tuple(s for s in hidden if (s.real > 0 if stated.continuous else abs(s) > 1))


def require_clear_boundary(scaled: Equation) -> None:
    """Raise ModelError when the Hamiltonian matrix of an indefinite cost has eigenvalues on the stability boundary."""
    s = _pencil_eigenvalues(scaled)
    off = s.real / (float(np.abs(s).max(initial=0.0)) or 1.0) if scaled.continuous else np.abs(s) - 1
    on = s[np.abs(off) <= BOUNDARY]
    if len(on):
        listed = ", ".join(_text(v) for v in on[:4])
        raise ModelError(
            f"the Riccati equation has no stabilising solution: the cost is indefinite, with the least eigenvalue "
            f"{weights.lowest_eigenvalue(weights.joined(scaled.Q, scaled.R, scaled.N)):.3g} (balanced), and has no "
            f"lower bound, for its Hamiltonian matrix has the eigenvalues {listed} on the stability boundary: raise Q"
        )


def hardly_moved(model: StateSpace, scaled: Equation) -> str:
    """Tell the mode that does not decay and is the nearest to one that no input moves.

    How near is the least singular value of [A - s I, B], balanced: a change of A and B of that size stops all inputs.
    """
    s = np.linalg.eigvals(scaled.A).astype(np.complex128)
    lasting = s[s.real >= 0 if scaled.continuous else np.abs(s) >= 1]
    if not lasting.size:
        return "all modes decay by themselves;"
    one = np.eye(len(s))
    split = [np.linalg.svd(np.hstack([scaled.A - v * one, scaled.B]))[:2] for v in lasting]
    k = min(range(len(split)), key=lambda i: float(split[i][1][-1]))
    U, sigma = split[k]
    who = structure.spelled(structure.direction(U[:, -1].conj(), model.states))
    reach = float(sigma[-1] / sigma[0])
    return (
        f"mode {lasting[k]:.4g} in {who} is moved least: a change by {reach:.0e} of A and B hides it from all inputs;"
    )


def require_unique_gain(model: StateSpace, weight: Array) -> None:
    """Raise ModelError when R, or S = R + B'XB, as `weight` (m, m) is singular."""
    if not weights.is_regular(weight):
        raise _untold(model)


def _untold(model: StateSpace) -> ModelError:
    return ModelError(
        f"R + B'XB is singular: the cost does not tell the inputs {', '.join(model.inputs)} apart, so that many gains "
        "are as good; weight each of them in R"
    )


def _near_boundary(s: Complex, fastest: float, continuous: bool) -> NDArray[np.bool_]:
    """Tell for each mode whether it, or the mean of those that may equal it, lies on the stability boundary."""
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


def _shifted(stated: Equation) -> tuple[Array, Array]:
    """Return A - B R^-1 N' and Q - N R^-1 N'."""
    shift = np.linalg.solve(stated.R, stated.N.T)
    return stated.A - stated.B @ shift, stated.Q - stated.N @ shift


def _zeros(model: StateSpace, stated: Equation) -> tuple[Complex, int]:
    """Return the modes s, with an input w, that the cost does not see: the zeros of A, B, [Q; N'], [N; R].

    Also returns the rank of the response of these to the inputs.
    """
    joint = weights.joined(stated.Q, stated.R, stated.N)
    n, names = len(model.states), tuple(f"y{k}" for k in range(len(joint)))
    seen = StateSpace(model.A, model.B, joint[:, :n], joint[:, n:], model.states, model.inputs, names, model.time)
    zeros = structure.transmission_zeros(seen)
    unseen = np.array([m.value for m in zeros.unseen], dtype=np.complex128)
    return np.concatenate([zeros.values, unseen]), zeros.rank


def _pencil_eigenvalues(e: Equation) -> Complex:
    """Return the eigenvalues of an equation's Hamiltonian matrix, in discrete time of its symplectic pencil."""
    if e.continuous:
        A, Q = _shifted(e)
        G = e.B @ np.linalg.solve(e.R, e.B.T)
        return np.linalg.eigvals(np.block([[A, -G], [-Q, -A.T]])).astype(np.complex128)
    none, one = np.zeros_like, np.eye(len(e.A))
    F = np.block([[e.A, none(e.A), e.B], [-e.Q, one, -e.N], [e.N.T, none(e.B.T), e.R]])
    E = np.block([[one, none(e.A), none(e.B)], [none(e.A), e.A.T, none(e.B)], [none(e.B.T), -e.B.T, none(e.R)]])
    values = scipy.linalg.eigvals(F, E)
    return np.asarray(values[np.isfinite(values)], dtype=np.complex128)


def _sees(scaled: Equation, poles: Complex) -> bool:
    """Tell whether the cost certainly sees each mode that does not decay."""
    joint = weights.joined(scaled.Q, scaled.R, scaled.N) if scaled.N.any() else scaled.Q
    if weights.is_above(joint, weights.ROUNDING):
        return True
    A, Q = _shifted(scaled)
    if not _doubtful(np.linalg.eigvals(A).astype(np.complex128), poles, scaled.continuous).any():
        return True
    s, V = np.linalg.eig(A)
    i = np.flatnonzero(_doubtful(s, poles, scaled.continuous))
    apart = np.abs(s[i, None] - s) + np.where(i[:, None] == np.arange(len(s)), np.inf, 0)
    cost = np.einsum("ji,jk,ki->i", V[:, i].conj(), Q, V[:, i]).real
    return bool((apart.min(axis=1) > ALONE * np.abs(s[i])).all() and (np.abs(cost) > SEEN * np.linalg.norm(Q)).all())


def _doubtful(s: Complex, poles: Complex, continuous: bool) -> NDArray[np.bool_]:
    """Tell for each mode whether it does not decay and has a mirror image near a pole."""
    lasting = s.real >= 0 if continuous else np.abs(s) >= 1
    mirror = -s.conj() if continuous else 1 / np.where(lasting, s, 1.0).conj()
    near = np.abs(poles - mirror[:, None]).min(axis=1) <= MIRRORED * np.abs(mirror)
    return np.asarray(lasting & near)


def _text(s: complex) -> str:
    return show.number(s.real, 4) if abs(s.imag) < 1e-9 * abs(s) else f"{s.real:.4g}{s.imag:+.4g}i"
