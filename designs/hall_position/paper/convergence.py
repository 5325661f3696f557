"""Audit of GLSDC over samples: what is left of a step, from where it converges, steps of 10 um under noise."""

from math import radians

import numpy as np

from designs.hall_position.paper.stage import UM, Array, Stage, grid
from models import hall_chain, hall_correction
from models.hall_two_waves import PlanarArray
from synth.report.audit import Outcome, Published, recomputes
from synth.timing import Discrete

STEP = 10e-6  # m, of Fig. 12: small, so that the corrections are those of a line
INNER = (1, 5, 6, 7)  # corrections a sample
LEFT = 0.05  # of a step: it has converged
DRAWS, CORRECTIONS, SEED = 400, 200, 0
STARTS = {"1/4 pitch and 5 degrees": (0.25, 5.0), "1/16 pitch and 5 degrees": (0.0625, 5.0)}
FOUND = 1e-6  # m
STEPS, TREAD, ALONG, PERIOD, SCALE = 4, 40, 10, 1 / 800, 0.2  # of the staircase; samples of a stair, s
MOST = 0.5  # part of the pitch


@recomputes("K-7", "K-7.alpha", "K-7.steps")
def convergence(stage: Stage, printed: Published) -> Outcome:
    """Recompute what is left of a step after the printed samples, by the corrections in a sample."""
    scale, samples = printed["alpha"].value, round(printed["steps"].value)
    left = {n: remaining(stage.pair, scale, samples * n) for n in INNER}
    needed = next(n for n in range(1, 50) if (1 - scale) ** (samples * n) < LEFT)
    figures = [
        (f"of a step, made after {samples} samples, corrections in each: {n}", 100 * (1 - v), "%")
        for n, v in left.items()
    ]
    figures += [("corrections in a sample that leave less than 5 %", float(needed), "1")]
    for name, array in (("two", stage.pair), ("three", stage.three)):
        found = {within: from_drawn(array, scale, *of) for within, of in STARTS.items()}
        figures += [(f"{name} sensors, random starts within {n}, found", 100 * v, "%") for n, v in found.items()]
    pole, period = 1 - scale, printed["time"].value * 1e-3 / samples
    figures += [("corner of one correction a sample", -np.log(pole) / period / (2 * np.pi), "Hz")]
    figures += [("noise that it lets through", float(np.sqrt(scale / (2 - scale))), "1")]
    return Outcome(figures, left[1] < LEFT, left[INNER[1]] < LEFT)


def remaining(of: PlanarArray, scale: float, corrections: int) -> float:
    """Return the median part of a step of X that is left after so many corrections, over the pitch."""
    q = grid(of, 20)
    start = q - np.array([[STEP], [0.0], [0.0]])
    end = hall_correction.settled(of, hall_correction.volts(of, q), start, scale, corrections)
    return float(np.median(np.abs(end[0] - q[0]))) / STEP


def from_drawn(of: PlanarArray, scale: float, reach: float, turn: float) -> float:
    """Return the part of drawn starts, within `reach` pitches and `turn` degrees, that end where the body is."""
    q, off = drawn(of, reach, turn)
    end = hall_correction.settled(of, hall_correction.volts(of, q), q + off, scale, CORRECTIONS)
    return float(np.mean(np.hypot(*(end - q)[:2]) < FOUND))


def drawn(of: PlanarArray, reach: float, turn: float) -> tuple[Array, Array]:
    """Return poses (3, N) at yaw 0 in the pitch, and by how much the starts are off."""
    rng = np.random.default_rng(SEED)
    q = np.vstack([rng.uniform(0, of.pitch, (2, DRAWS)), np.zeros(DRAWS)])
    sides = np.array([[reach * of.pitch], [reach * of.pitch], [radians(turn)]])
    return q, sides * rng.uniform(-1, 1, (3, DRAWS))


@recomputes("K-10", "sensitivity", "noise")
def staircase(stage: Stage, printed: Published) -> Outcome:
    """Recompute the output of GLSDC over steps of the printed size, places all over the pitch."""
    step, figures, seen = printed["step"].value * UM, [], {}
    for name, known in (("yaw known", True), ("yaw estimated", False)):
        found = treads(stage, step, known)
        risen, noise = np.diff(found.mean(axis=1), axis=0), found.std(axis=1).mean(axis=0)
        seen[name] = noise < step / 2
        figures += [
            (f"step of the output, {name}, median", float(np.median(risen)) / UM, "um"),
            (f"noise of the output, {name}, median", float(np.median(noise)) / UM, "um rms"),
            (f"noise of the output, {name}, largest", float(noise.max()) / UM, "um rms"),
            (f"places where it is below half a step, {name}", 100 * float(np.mean(seen[name])), "%"),
        ]
    agree = bool(seen["yaw known"].all() and seen["yaw estimated"].mean() > MOST)
    return Outcome(figures, agree)


def treads(stage: Stage, step: float, yaw_known: bool) -> Array:
    """Return the estimates of X in m of bodies that climb stairs, (stairs, samples, N), the first ones left out."""
    of, time = stage.pair, Discrete(PERIOD)
    q = grid(of, ALONG)
    size = 2 * len(of.positions) * q.shape[1]
    noise = hall_chain.noise(stage.chain, time, (size, (STEPS + 1) * TREAD), SEED).T.reshape(
        STEPS + 1, TREAD, 2, -1, q.shape[1]
    )
    found, at = [], q
    for stair, more in enumerate(noise):
        true = q + np.array([[step * stair], [0.0], [0.0]])
        clean = hall_correction.volts(of, true)
        for now in more:
            at = hall_correction.settled(of, clean + now, at, SCALE, INNER[1], yaw_known)
            found.append(at[0])
    return np.array(found).reshape(STEPS + 1, TREAD, -1)[:, TREAD // 2 :]
