"""Loop transfer recovery (LTR): an LQG loop approaches the loop of state feedback, or of the filter, as q grows.

        +--[ K ]<-- x^ --[estimator]<--+
        |                              |
        +-->(i)---->[ G ]------>(o)----+        the loop is cut at (i) or at (o); I + ratio is singular at its poles

    at the input     target -K (s I - A)^-1 B,      ratio -F(s) G(s),      filter for W + q^2 B B'
    at the output    target  C (s I - A)^-1 L,      ratio -G(s) F(s),      gain for Q + q^2 C'C

F is the compensator from y to u. As q grows, the loop of a continuous plant converges to the target if the plant has no
zero in the right half plane and its response has full rank, with no more inputs than outputs at the input, and no more
outputs than inputs at the output. In discrete time this also requires C B of full rank and the current form of the
controller, which is used here: the predictor does not recover. A larger q costs more noise: each row states both.
Source: Doyle, Stein (1979, 1981); Maciejowski, IEEE Trans. AC-30 (1985).

Library: no design uses it yet; docs/library.md has an example.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from synth import arguments, show
from synth.analyse import structure
from synth.errors import ModelError, SignalError
from synth.statespace import Array, Complex, StateSpace, System, readonly
from synth.synthesise.feedback import lqr, weights
from synth.synthesise.observers import kalman, lqg, noise
from synth.timing import Continuous, Discrete

POINTS = 400
MARGIN = 1e-9  # of a zero's size: a slower decay counts as none


@dataclass(frozen=True, eq=False)
class Step:
    """The controller for one q, the distance of its loop from the target, and its cost and deviations under noise."""

    q: float
    controller: lqg.Controller
    distance: float
    noise: lqg.Expectation


@show.result
class Recovery:
    """A sweep over q at the `place` "input" or "output"; `obstacles` state why the distance does not tend to 0.

    The distance is max |ratio - target| / |target|, largest singular values, at POINTS frequencies over `band` (rad/s).
    """

    place: str
    steps: tuple[Step, ...]
    band: tuple[float, float]
    obstacles: tuple[str, ...]

    @property
    def distances(self) -> Array:
        """The distances (k,), in the order of q."""
        return readonly([step.distance for step in self.steps])

    def sheet(self) -> show.Sheet:
        """Return the distance and the noise of each q, and the obstacles."""
        names = tuple(self.steps[0].noise.deviations)
        units = self.steps[0].noise.units
        columns = ("distance", *(show.with_unit(f"deviation of {name}", units[name]) for name in names))
        values = [[step.distance, *step.noise.deviations.values()] for step in self.steps]
        table = show.matrix("q", values, tuple(show.number(step.q) for step in self.steps), columns)
        low, high = (show.number(w) for w in self.band)
        lines = (f"largest relative distance from the target loop over {low} .. {high} rad/s", *self.obstacles)
        return show.Sheet(f"Loop transfer recovery at the {self.place}", lines, (table,))


@arguments.checked
def at_input(
    gain: lqr.Gain,
    system: System,
    W: weights.Weight,
    V: weights.Weight,
    qs: Sequence[float],
    band: tuple[float, float],
    G: noise.NoiseInput = None,
) -> Recovery:
    """Sweep the filter for W + q^2 B B' at a gain, which may have integral states; B are the columns of its inputs.

    W, V and G are those of `kalman` in the model's own time, and the noise of each row; `band` is in rad/s.

    Raises SignalError for a q below 0 or a band that is not 0 < low < high (below the Nyquist frequency); ModelError
    for a plant with a direct term; else as `kalman` and `lqg`.
    """
    acting = noise.white(system, W, V, G)
    model, e = acting.model, acting.noise
    plant, s = model.select(model.outputs, gain.inputs), _points(model, qs, band)
    full = lqr.with_integrators(plant, lqg.integrals(gain, plant))
    full = replace(full, C=np.eye(len(full.A)), D=np.zeros_like(full.B), outputs=full.states)
    target = _require_nonzero(-gain.K @ full.select(gain.states, gain.inputs).response(s), "K")

    def step(q: float) -> Step:
        raised = replace(e, W=readonly(e.W + q * q * _outer_product(plant.B)))
        controller = lqg.current(gain, kalman.steady(replace(acting, noise=raised)))
        ratio = -_compensator(controller, s) @ plant.response(s)
        return Step(float(q), controller, _distance(ratio, target), lqg.expected_cost(controller, e))

    return Recovery("input", tuple(step(q) for q in qs), band, _obstacles(plant, "input"))


@arguments.checked
def at_output(
    estimator: kalman.Estimator,
    Q: weights.Weight,
    R: weights.Weight,
    qs: Sequence[float],
    band: tuple[float, float],
) -> Recovery:
    """Sweep the gain for Q + q^2 C'C (n, n) and R (m, m), matrices, diagonals or by name, at an estimator.

    Raises as `at_input`; as `lqr.lqr` for the weights.
    """
    plant, e = estimator.model, estimator.noise
    s = _points(plant, qs, band)
    Q, R = weights.semidefinite("Q", Q, plant.states), weights.definite("R", R, plant.inputs)
    p = len(plant.outputs)
    target = replace(plant, B=estimator.L, D=np.zeros((p, p)), inputs=plant.outputs).response(s)
    target = _require_nonzero(target, "L")

    def step(q: float) -> Step:
        controller = lqg.current(lqr.lqr(plant, Q + q * q * _outer_product(plant.C.T), R), estimator)
        ratio = -plant.response(s) @ _compensator(controller, s)
        return Step(float(q), controller, _distance(ratio, target), lqg.expected_cost(controller, e))

    obstacles = _obstacles(plant, "output")
    if isinstance(plant.time, Discrete) and e.S.any():
        obstacles += ("the noise on states and outputs is correlated: at the output of a sampled plant L is not A M",)
    return Recovery("output", tuple(step(q) for q in qs), band, obstacles)


def _points(model: StateSpace, qs: Sequence[float], band: tuple[float, float]) -> Complex:
    """Return the frequencies of the band as points in s or in z."""
    low, high = arguments.real("limits of the band", band).ravel()[:2] if np.size(band) == 2 else (np.nan, np.nan)
    sweep = arguments.real("numbers q of the sweep", qs)
    top = np.pi / model.time.period_s if isinstance(model.time, Discrete) else np.inf
    if not 0 < low < high < top:
        raise SignalError(f"the band is {band} rad/s: give 0 < low < high, and high below {top:.6g} rad/s")
    if sweep.ndim != 1 or not sweep.size or not ((sweep >= 0) & (sweep < np.inf)).all():
        raise SignalError(f"the sweep is over q = {qs}: give finite numbers >= 0, at least one")
    if model.D.any():
        raise ModelError(
            f"{', '.join(model.outputs)} depend directly on {', '.join(model.inputs)}: recovery needs a plant without "
            "a direct term; put the dynamics of actuators or sensors into the model"
        )
    s = 1j * np.geomspace(low, high, POINTS)
    return np.asarray(s if isinstance(model.time, Continuous) else np.exp(s * model.time.period_s), np.complex128)


def _outer_product(B: Array) -> Array:
    product = B @ B.T
    return (product + product.T) / 2


def _compensator(controller: lqg.Controller, s: Complex) -> Complex:
    F = controller.compensator.select(controller.gain.inputs, controller.estimator.model.outputs)
    return F.response(s)


def _require_nonzero(target: Complex, gain: str) -> Complex:
    """Return the target's response; raise ModelError where it is 0, as the distance is relative to it."""
    if not np.abs(target).max(axis=(1, 2), initial=0.0).all():
        raise ModelError(
            f"the target loop of the gain {gain} is 0 in the band: there is nothing to recover; choose weights or "
            f"noise for which {gain} acts, or leave the plant as it is"
        )
    return target


def _distance(ratio: Complex, target: Complex) -> float:
    distances = np.linalg.norm(ratio - target, ord=2, axis=(1, 2)) / np.linalg.norm(target, ord=2, axis=(1, 2))
    return float(distances.max())


def _obstacles(plant: StateSpace, place: str) -> tuple[str, ...]:
    """Return the reasons why the loop is not recovered at the `place` for any q."""
    zeros, sampled = structure.transmission_zeros(plant), isinstance(plant.time, Discrete)
    needed = len(plant.inputs if place == "input" else plant.outputs)
    obstacles = []
    if zeros.rank < needed:
        obstacles.append(
            f"the plant's response has rank {zeros.rank} but {needed} {place}s: no recovery at the {place}"
        )
    for z in zeros.values:
        if z.imag >= 0 and (abs(z) > 1 - MARGIN if sampled else z.real > -MARGIN * abs(z)):
            obstacles.append(f"the plant's zero {show.number(z)} does not decay: no recovery near it and above")
    if sampled and zeros.rank >= needed and np.linalg.matrix_rank(plant.C @ plant.B) < needed:
        obstacles.append(
            "C B does not have full rank: the plant responds later than in the next sample, and no gain compensates it"
        )
    return tuple(obstacles)
