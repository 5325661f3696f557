"""Whether a Riccati equation has a stabilising solution: (A, B) stabilisable and (Q, A) detectable.

Where there is a cross weight, A stands for A - B R^-1 N' and Q for Q - N R^-1 N'. A stable loop proves (A, B)
stabilisable. A mode s of A that the cost does not see and that does not decay leaves the optimal loop its mirror image,
-conj(s) or 1 / conj(s): without such a pole (Q, A) is detectable. A mode with such a pole is seen, too, when it stands
alone and its eigenvector costs something. Where this decides nothing, the modes are searched (Popov, Belevitch,
Hautus).
"""

import numpy as np
from numpy.typing import NDArray

from synth.analyse import structure
from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.synthesise import weights
from synth.synthesise.equation import Complex, Equation, decays

MARGIN = 1e-11  # of the fastest pole: what decays slower may be the rounding error of a mode that does not decay
MIRRORED = 0.02  # of a mode: a pole nearer than this to its mirror image may be one
ALONE = 1e-3  # of a mode: others are farther from one that stands alone
SEEN = 1e-10  # of the largest eigenvalue of Q


def prove(model: StateSpace, stated: Equation, scaled: Equation, poles: Complex) -> None:
    """Raise ModelError unless the poles of the loop decay and the problem is stabilisable and detectable.

    `scaled` is the balanced equation.
    """
    size = float(np.abs(poles).max())
    rates = -poles.real / (size or 1.0) if stated.continuous else 1 - np.abs(poles)
    if rates.min() < MARGIN or not _sees(scaled, poles):
        search(model, stated)
    if not decays(poles, stated.continuous):
        raise ModelError(
            f"the Riccati equation's solution leaves the pole {poles[np.argmin(rates)]:.4g}, which does not decay: "
            "scale the weights and the states so that they are of like size"
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


def search(model: StateSpace, stated: Equation) -> None:
    """Raise ModelError naming a mode that makes the problem unsolvable, if there is one."""
    structure.require_stabilisable(model.A, model.B, model.states, model.inputs, model.time)
    shift = np.linalg.solve(stated.R, stated.N.T)
    Q = stated.Q - stated.N @ shift
    structure.require_detectable(model.A - model.B @ shift, Q, model.states, "Q", model.time)


def _sees(scaled: Equation, poles: Complex) -> bool:
    """Tell whether the cost certainly sees each mode that does not decay."""
    joint = weights.joined(scaled.Q, scaled.R, scaled.N) if scaled.N.any() else scaled.Q
    if weights.is_above(joint, weights.ROUNDING):
        return True
    shift = np.linalg.solve(scaled.R, scaled.N.T)
    A, Q = scaled.A - scaled.B @ shift, scaled.Q - scaled.N @ shift
    if not _doubtful(np.linalg.eigvals(A).astype(np.complex128), poles, scaled.continuous).any():
        return True
    s, V = np.linalg.eig(A)
    i = np.flatnonzero(_doubtful(s, poles, scaled.continuous))
    apart = np.abs(s[i, None] - s) + np.where(i[:, None] == np.arange(len(s)), np.inf, 0)
    cost = np.einsum("ji,jk,ki->i", V[:, i].conj(), Q, V[:, i]).real
    return bool((apart.min(axis=1) > ALONE * np.abs(s[i])).all() and (cost > SEEN * np.linalg.norm(Q)).all())


def _doubtful(s: Complex, poles: Complex, continuous: bool) -> NDArray[np.bool_]:
    """Tell for each mode whether it does not decay and has a mirror image near a pole."""
    lasting = s.real >= -MARGIN * np.abs(s).max() if continuous else np.abs(s) >= 1 - MARGIN
    mirror = -s.conj() if continuous else 1 / np.where(lasting, s, 1.0).conj()
    near = np.abs(poles - mirror[:, None]).min(axis=1) <= MIRRORED * np.abs(mirror)
    return np.asarray(lasting & near)
