"""Audit of the Kalman filter (6)-(16): bandwidth, what it leaves of the noise, and the recursion as printed.

The axes do not meet in (7)-(13). Each has position, rate and acceleration, driven by a jerk of variance q through Gamma
of (11), and its position is measured with the variance (5e-5)^2, m^2 or rad^2. The filter is the steady one whose
estimate has used the sample of its own instant. Its bandwidth is where the power from the measured position to the
estimated one falls through a half. Noise is white, with the stage at rest.
"""

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from designs.planar_6dof.paper.bench import Bench
from synth.report.audit import Outcome, Published, recomputes
from synth.statespace import StateSpace
from synth.synthesise import belief, kalman, noise
from synth.timing import Discrete, period

Array = NDArray[np.float64]

HZ = {"800 Hz": ("Y-7.rate_lqg", 1.0), "1 kHz": ("Y-7.rate", 1e3)}  # where the rates are printed, and their units
SOURCES = ("Y-13.deviation", "Y-7.rate", "Y-7.rate_lqg")
SECONDS = 1.0  # after which the recursions are compared
NEAR = 1e-2  # relative: a gain this near to the steady one has converged
UM = 1e-6


@recomputes("Y-13", "Y-13.q", "Y-13.bandwidth", *SOURCES)
def bandwidth_of_x(bench: Bench, printed: Published) -> Outcome:
    """Recompute the bandwidth in x and y."""
    return _bandwidth(bench, printed)


@recomputes("Y-14", "Y-14.q", "Y-14.bandwidth", *SOURCES)
def bandwidth_of_phi(bench: Bench, printed: Published) -> Outcome:
    """Recompute the bandwidth in phi."""
    return _bandwidth(bench, printed)


def _bandwidth(bench: Bench, printed: Published) -> Outcome:
    q, wanted = printed["q"].value, printed["bandwidth"].value
    filters = steady(bench, q)
    bandwidths = {name: half_power(f.current()) for name, f in filters.items()}
    figures = [(f"bandwidth at {n}", value, "Hz") for n, value in bandwidths.items()]
    figures += [(f"bandwidth of the prediction at {n}", half_power(f.predictor()), "Hz") for n, f in filters.items()]
    needed, unit = _deviation(q, 1 / rates(bench)["1 kHz"], wanted), printed["q"].unit.split("^")[0]
    figures.append((f"deviation of the measurement that makes {printed['bandwidth'].text} Hz at 1 kHz", needed, unit))
    return Outcome(figures, any(printed["bandwidth"].agrees(value) for value in bandwidths.values()))


@recomputes("Y-15", "Y-13.q", "Y-14.q", *SOURCES)
def reduction(bench: Bench, printed: Published) -> Outcome:
    """Recompute by how much the filter lowers the noise."""
    figures = []
    for axis, source in (("x and y", "Y-13.q"), ("phi", "Y-14.q")):
        left = {n: passed(f.current()) for n, f in steady(bench, bench.printed(source)).items()}
        figures += [(f"noise left in {axis} at {n}", share, "1") for n, share in left.items()]
        figures += [(f"reduction in {axis} at {n}", 100 * (1 - share), "%") for n, share in left.items()]
    agree = any(printed["reduction"].agrees(v) for name, v, _ in figures if name.startswith("reduction in x"))
    return Outcome(figures, agree)


@recomputes("Y-38", "Y-13.q", *SOURCES, "Y-38.before", "Y-38.after")
def figure_5(bench: Bench, printed: Published) -> Outcome:
    """Recompute the noise level after the filter from that before it."""
    before, after = printed["before"], printed["after"]
    filters = steady(bench, bench.printed("Y-13.q"))
    levels = {n: before.value * passed(f.current()) for n, f in filters.items()}
    figures = [(f"level after the filter at {n}", level / UM, "um") for n, level in levels.items()]
    figures.append(("reduction between the printed levels", 100 * (1 - after.value / before.value), "%"))
    return Outcome(figures, all(abs(level - after.value) <= after.last_digit / 2 for level in levels.values()))


@recomputes("Y-39", "Y-13.q", "Y-13.deviation", "Y-7.rate_lqg")
def recursion(bench: Bench, printed: Published) -> Outcome:
    """Recompute the gain of the position by (14)-(16) as printed, and with P updated by each sample."""
    q, rate = bench.printed("Y-13.q"), rates(bench)["800 Hz"]
    arguments = (q, 1 / rate, bench.printed("Y-13.deviation"), printed["p0"].value)
    as_printed, updated = (gains(*arguments, update) for update in (False, True))
    final = estimator(*arguments[:3]).M[0, 0]
    slow = np.flatnonzero(np.abs(updated / final - 1) > NEAR)
    figures = [
        ("gain after 1 s, as printed", as_printed[-1], "1"),
        ("gain after 1 s, P updated", updated[-1], "1"),
        ("steady gain", final, "1"),
        ("time until the gain is within 1 % of it, P updated", 1e3 * (slow[-1] + 1) / rate, "ms"),
    ]
    return Outcome(figures, as_printed[-1] < 0.5, updated[-1] < 0.5)


def rates(bench: Bench) -> dict[str, float]:
    """Return the printed sample rates in Hz by name."""
    return {name: unit * bench.printed(source) for name, (source, unit) in HZ.items()}


def steady(bench: Bench, q: float) -> dict[str, kalman.Estimator]:
    """Return the filter of one axis at each sample rate."""
    deviation = bench.printed("Y-13.deviation")
    return {name: estimator(q, 1 / rate, deviation) for name, rate in rates(bench).items()}


def model(period_s: float) -> tuple[StateSpace, Array]:
    """Return (11), (12) of one axis and its Gamma (3, 1)."""
    T = period_s
    A, Gamma = np.array([[1, T, T * T / 2], [0, 1, T], [0, 0, 1]]), np.array([[T**3 / 6], [T**2 / 2], [T]])
    names = (("q", "v", "a"), (), ("y",), Discrete(T))
    return StateSpace(A, np.zeros((3, 0)), np.eye(1, 3), np.zeros((1, 0)), *names), Gamma


@cache
def estimator(q: float, period_s: float, deviation: float) -> kalman.Estimator:
    """Return the steady filter of one axis."""
    axis, Gamma = model(period_s)
    return kalman.discrete(axis, np.array([q]), np.array([deviation**2]), Gamma)


def half_power(form: StateSpace) -> float:
    """Return where the power from the measured to the estimated position falls through a half, in Hz."""
    T = period(form.time)

    def excess(frequency: float) -> float:
        return float(np.abs(form.response(np.exp(2j * np.pi * frequency * T))[0, 0, 0]) ** 2 - 0.5)

    grid = np.linspace(0, 0.5 / T, 400)[1:]
    above = np.abs(form.response(np.exp(2j * np.pi * grid * T))[:, 0, 0]) ** 2 > 0.5
    last = int(np.flatnonzero(above)[-1])
    return float(brentq(excess, grid[last], grid[last + 1], xtol=1e-10)) if last + 1 < len(grid) else np.inf


def passed(form: StateSpace) -> float:
    """Return the deviation of the estimated position over that of a white measurement."""
    X = noise.stationary(form.A, form.B @ form.B.T, form.time)
    return float(np.sqrt((form.C @ X @ form.C.T + form.D @ form.D.T)[0, 0]))


@cache
def gains(q: float, period_s: float, deviation: float, p0: float, update: bool) -> Array:
    """Return the gain of the position (N,) over a second from P_0 = p0 I, with or without an update of P."""
    axis, Gamma = model(period_s)
    W, V = q * Gamma @ Gamma.T, deviation**2
    now, history = belief.initial(axis, p0 * np.ones(3)), []
    for _ in range(round(SECONDS / period_s)):
        history.append(now.P[0, 0] / (now.P[0, 0] + V))
        now = belief.update(now, axis, np.array([V]), np.zeros(1)) if update else now
        now = belief.predict(now, axis, (W + W.T) / 2)
    return np.array(history)


@cache
def _deviation(q: float, period_s: float, wanted: float) -> float:
    """Return the deviation of the measurement for which the bandwidth is as wanted, in Hz."""

    def excess(log_deviation: float) -> float:
        return half_power(estimator(q, period_s, float(np.exp(log_deviation))).current()) - wanted

    return float(np.exp(brentq(excess, np.log(1e-6), np.log(1e-3), xtol=1e-10)))
