"""Structured singular value (MATLAB `mussv`) of a complex matrix M (p, p) for diagonal complex uncertainty.

    mu(M) = 1 / min { max |delta_i| : det(I - M diag(delta)) = 0 },          0 if no such delta exists

    rho(M Q) <= mu(M) <= sigma_max(D M D^-1),       Q = diag(exp(i phi)),    D = diag(d), d > 0

The least upper bound over D is mu for p <= 3 (Packard, Doyle 1993). log sigma_max is convex in log d, so a descent
finds the minimum: balancing (Osborne 1960) comes close to it, then Newton's method follows the central path of

    F(log x) = -log det(t I - N^H N),  N = D M D^-1,  x = d^2,          t falling to sigma_max^2.

At a centre sigma_max^2 is within about p (t - sigma_max^2) of the minimum. Any D gives an upper bound; any Q gives a
lower bound and its delta. All matrices of a batch (k, p, p) are treated at once.
"""

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from synth.statespace import Array, Complex

STEPS = 100  # of Newton's method at most; about ten are usual, more where singular values meet
CENTRED_DECREMENT = 0.5  # Newton decrement below which t decreases
STARTS = 12  # of the power iteration, from random phases with a fixed seed
MAX_ITERATIONS = 50  # of the power iteration


@dataclass(frozen=True, eq=False)
class Upper:
    """sigma_max(D M D^-1) (k,), an upper bound of mu for any D, and the squares x = d^2 (k, p) that give it."""

    value: Array
    scaling: Array


@dataclass(frozen=True, eq=False)
class Lower:
    """A lower bound of mu and the delta (p,) of modulus 1/value with det(I - M diag(delta)) = 0."""

    value: float
    delta: Complex


def scaled(M: Complex, x: Array) -> Complex:
    """Return D M D^-1 for x = d^2."""
    d = np.sqrt(x)
    return np.asarray(M * (d[..., :, None] / d[..., None, :]))


def gain(M: Complex, x: Array) -> Array:
    """Return sigma_max(D M D^-1) of each matrix of M (k, p, p), x (p,) or (k, p)."""
    if M.shape[-2:] == (1, 1):
        return np.asarray(np.abs(M[..., 0, 0]))
    return np.asarray(np.linalg.svd(scaled(M, x), compute_uv=False)[..., 0])


def osborne_scaling(M: Complex, sweeps: int = 4) -> Array:
    """Return x = d^2 (k, p) that gives row i and column i of D M D^-1 similar sizes (Osborne).

    Entries below 1e-8 of the largest count as 1e-8 of it; this keeps the scales of a reducible matrix finite.
    """
    size = np.abs(M) ** 2
    top = size.max(axis=(-1, -2), keepdims=True)
    size = size + np.where(top > 0, 1e-16 * top, 1.0)
    k, p = size.shape[0], size.shape[-1]
    size[:, np.arange(p), np.arange(p)] = 0.0
    x = np.ones((k, p))
    for _ in range(sweeps if p > 1 else 0):
        for i in range(p):
            x[:, i] = np.sqrt((size[:, :, i] * x).sum(axis=1) / (size[:, i, :] / x).sum(axis=1))
        x /= np.exp(np.log(x).mean(axis=1, keepdims=True))
    return x


def upper(M: Complex, tolerance: float = 1e-6, enough: float = 0.0) -> Upper:
    """Return the least upper bound over D for each matrix of M (k, p, p), within a relative `tolerance`.

    A bound below `enough` is not minimised further.
    """
    x = osborne_scaling(M) if M.shape[-1] > 1 else np.ones((len(M), M.shape[-1]))
    value = gain(M, x)
    if M.shape[-1] > 1:
        busy = np.flatnonzero(value > 0)
        scale = value[busy]
        x[busy], relative = _central_path(M[busy] / scale[:, None, None], x[busy], tolerance, (enough / scale) ** 2)
        value[busy] *= relative
    return Upper(value, x)


def _central_path(M: Complex, x: Array, tolerance: float, enough: Array) -> tuple[Array, Array]:
    """Return the best x and its sigma_max along the central path, until its square is below `enough` (k,).

    M (k, p, p) has gains near 1.
    """
    near = max(2 * tolerance / M.shape[-1], 1e-10)
    best, least, busy = x.copy(), np.full(len(M), np.inf), np.arange(len(M))
    last, t, centred = x, np.full(len(M), np.inf), np.zeros(len(M), dtype=bool)
    for _ in range(STEPS):
        N = scaled(M[busy], x)
        G = N.conj().swapaxes(1, 2) @ N
        size = np.linalg.eigvalsh(G)[:, -1]
        better = size < least[busy]
        least[busy[better]], best[busy[better]] = size[better], x[better]
        t = np.where(np.isinf(t), 1.1 * size, np.where(centred & (size < t), size + 0.1 * (t - size), t))
        t = np.maximum(t, least[busy] * (1 + 0.5 * near))
        outside = size >= t  # the step was too long: halve it
        step, decrement = _newton(N, G, np.where(outside, 1.1 * size, t))
        centred = (decrement < CENTRED_DECREMENT) & ~outside
        following = np.where(outside[:, None], np.sqrt(last * x), x * np.exp(step))
        last = np.where(outside[:, None], last, x)
        stay = (~centred | (t > least[busy] * (1 + near))) & (least[busy] >= enough[busy])
        busy, x, last, t, centred = busy[stay], following[stay], last[stay], t[stay], centred[stay]
        if not len(busy):
            break
    return best, np.sqrt(least)


def _newton(N: Complex, G: Complex, t: Array) -> tuple[Array, Array]:
    """Return the damped step of F in log x and its decrement, G = N^H N."""
    p = N.shape[-1]
    W = np.linalg.inv(t[:, None, None] * np.eye(p) - G)
    NW = N @ W
    V = NW @ N.conj().swapaxes(1, 2)
    w, v = np.einsum("kii->ki", W).real, np.einsum("kii->ki", V).real
    K, T = np.abs(NW) ** 2, t[:, None, None]
    gradient, coupled = v - t[:, None] * w + 1, t[:, None] * w - v
    square = T**2 * np.abs(W) ** 2
    H = square - T * (K + K.swapaxes(1, 2)) + np.abs(V) ** 2 - np.eye(p) * coupled[:, None, :]
    # A common shift of all log x has no effect: fix it, and regularise the relative shifts of uncoupled parts.
    H += np.einsum("kii->k", square)[:, None, None] * (np.ones((p, p)) / p**2 + 1e-14 * np.eye(p))
    step = -np.linalg.solve(H, gradient[:, :, None])[:, :, 0]
    decrement = np.sqrt(np.maximum(-(step * gradient).sum(axis=1), 0.0))
    return np.clip(step / np.maximum(1.0, decrement + 0.75)[:, None], -3.0, 3.0), decrement


def lower(M: Complex, enough: float = np.inf) -> Lower:
    """Return a lower bound of mu for one matrix M (p, p), and its delta.

    The phases come from the power iteration (Packard, Fan, Doyle 1988) with several starts; a gradient ascent of
    log rho(M Q) improves the best ones, the second of them where the first stays below `enough`.
    """
    if not M.any():
        return Lower(0.0, np.full(len(M), np.inf + 0j))
    if len(M) == 1:
        return Lower(float(abs(M[0, 0])), 1 / M[0])
    phases = _power(M)
    radii = np.abs(np.linalg.eigvals(M * np.exp(1j * phases)[:, None, :])).max(axis=1)
    first, second = np.argsort(radii)[:-3:-1]
    best = _certificate(M, _ascend(M, phases[first]))
    return (
        best if best.value >= enough else max(best, _certificate(M, _ascend(M, phases[second])), key=lambda c: c.value)
    )


def _certificate(M: Complex, phases: Array) -> Lower:
    q = np.exp(1j * phases)
    values = np.linalg.eigvals(M * q)
    largest = values[np.abs(values).argmax()]
    return Lower(float(abs(largest)), q / largest if largest else np.full(len(q), np.inf + 0j))


def _power(M: Complex) -> Array:
    """Return the final phases (STARTS, p) of the power iteration."""
    rng, p = np.random.default_rng(0), len(M)
    b = np.exp(2j * np.pi * rng.random((STARTS, p)))
    b[0] = 1.0
    w, a = b, b
    for _ in range(MAX_ITERATIONS):
        a = _unit(b @ M.T)
        w = _unit((np.abs(w) * _sign(a)) @ M.conj())
        b = np.abs(a) * _sign(w)
    return np.angle(_sign(w) * _sign(a).conj())


def _unit(vectors: Complex) -> Complex:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-300))


def _sign(values: Complex) -> Complex:
    size = np.abs(values)
    return np.asarray(np.where(size > 0, values / np.maximum(size, 1e-300), 1.0))


def _ascend(M: Complex, phases: Array) -> Array:
    def cost(phi: Array) -> tuple[float, Array]:
        values, right = np.linalg.eig(M * np.exp(1j * phi))
        k = np.abs(values).argmax()
        left = np.linalg.pinv(right)[k]
        size = abs(values[k])
        return -float(np.log(max(size, 1e-300))), np.imag(left * right[:, k])

    return np.asarray(minimize(cost, phases, jac=True, method="BFGS", options={"gtol": 1e-9}).x)
