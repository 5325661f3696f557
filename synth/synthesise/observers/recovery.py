"""Loop transfer recovery: an LQG loop is brought near the loop of state feedback, or of the filter, by one number q.

        +--[ K ]<-- x^ --[estimator]<--+
        |                              |
        +-->(i)---->[ G ]------>(o)----+        the loop is cut at (i) or at (o); I + ratio is singular at its poles

    at the input     target -K (s I - A)^-1 B,      ratio -F(s) G(s),      filter for W + q^2 B B'
    at the output    target  C (s I - A)^-1 L,      ratio -G(s) F(s),      gain for Q + q^2 C'C

where F is the compensator from y to u. As q grows, the loop of a continuous plant tends to the target when no zero of
the plant lies on the right and the response has full rank, at the input with no more inputs than outputs, at the output
the other way round. In discrete time that takes a plant that answers in the next sample (C B of full rank), and the
current form of the controller, which is swept here: the predictor does not recover. What q gives in the loop it takes
in noise: each row has both.
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
MARGIN = 1e-9  # of a zero's size: what decays slower counts as not decaying


@dataclass(frozen=True, eq=False)
class Step:
    """The controller for one q, the distance of its loop from the target, and the noise that it makes."""

    q: float
    controller: lqg.Controller
    distance: float
    noise: lqg.Expectation


@show.result
class Recovery:
    """A sweep over q at the `place` "input" or "output"; `obstacles` say why the distance does not tend to 0.

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
        columns = ("distance", *(show.named(f"deviation of {name}", units[name]) for name in names))
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
    G: noise.Entry = None,
) -> Recovery:
    """Sweep the filter for W + q^2 B B' at a gain, which may have integral states; B are the columns of its inputs.

    W, V and G are those of `kalman` in the model's own time, and the noise of each row; `band` is in rad/s.

    Raises SignalError for a q below 0, a band that is not 0 < low < high (below Nyquist's); ModelError for a plant with
    a direct term; else as `kalman` and `lqg`.
    """
    acting = noise.white(system, W, V, G)
    model, e = acting.model, acting.noise
    plant, s = model.select(model.outputs, gain.inputs), _points(model, qs, band)
    full = lqr.integral(plant, lqg.integrals(gain, plant))
    full = replace(full, C=np.eye(len(full.A)), D=np.zeros_like(full.B), outputs=full.states)
    target = _present(-gain.K @ full.select(gain.states, gain.inputs).response(s), "K")

    def step(q: float) -> Step:
        raised = replace(e, W=readonly(e.W + q * q * _square(plant.B)))
        controller = lqg.current(gain, kalman.steady(replace(acting, noise=raised)))
        ratio = -_compensator(controller, s) @ plant.response(s)
        return Step(float(q), controller, _distance(ratio, target), lqg.expected(controller, e))

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
    target = _present(target, "L")

    def step(q: float) -> Step:
        controller = lqg.current(lqr.lqr(plant, Q + q * q * _square(plant.C.T), R), estimator)
        ratio = -plant.response(s) @ _compensator(controller, s)
        return Step(float(q), controller, _distance(ratio, target), lqg.expected(controller, e))

    obstacles = _obstacles(plant, "output")
    if isinstance(plant.time, Discrete) and e.S.any():
        obstacles += ("the noise on states and outputs is correlated: at the output of a sampled plant L is not A M",)
    return Recovery("output", tuple(step(q) for q in qs), band, obstacles)


def _points(model: StateSpace, qs: Sequence[float], band: tuple[float, float]) -> Complex:
    """Return the points of the band in s or in z."""
    low, high = arguments.real("limits of the band", band).ravel()[:2] if np.size(band) == 2 else (np.nan, np.nan)
    sweep = arguments.real("numbers q of the sweep", qs)
    top = np.pi / model.time.period_s if isinstance(model.time, Discrete) else np.inf
    if not 0 < low < high < top:
        raise SignalError(f"the band is {band} rad/s: give 0 < low < high, and high below {top:.6g} rad/s")
    if sweep.ndim != 1 or not sweep.size or not ((sweep >= 0) & (sweep < np.inf)).all():
        raise SignalError(f"the sweep is over q = {qs}: give finite numbers >= 0, at least one")
    if model.D.any():
        raise ModelError(
            f"{', '.join(model.outputs)} depend on {', '.join(model.inputs)} at once: recovery needs a plant without a "
            "direct term; put the dynamics of actuators or sensors into the model"
        )
    s = 1j * np.geomspace(low, high, POINTS)
    return np.asarray(s if isinstance(model.time, Continuous) else np.exp(s * model.time.period_s), np.complex128)


def _square(B: Array) -> Array:
    product = B @ B.T
    return (product + product.T) / 2


def _compensator(controller: lqg.Controller, s: Complex) -> Complex:
    F = controller.compensator.select(controller.gain.inputs, controller.estimator.model.outputs)
    return F.response(s)


def _present(target: Complex, gain: str) -> Complex:
    """Return the target's response; raise ModelError where it is 0, so that no distance is relative to it."""
    if not np.abs(target).max(axis=(1, 2), initial=0.0).all():
        raise ModelError(
            f"the target loop of the gain {gain} is 0 in the band: there is nothing to recover; choose weights or "
            f"noise for which {gain} acts, or leave the plant as it is"
        )
    return target


def _distance(ratio: Complex, target: Complex) -> float:
    apart = np.linalg.norm(ratio - target, ord=2, axis=(1, 2)) / np.linalg.norm(target, ord=2, axis=(1, 2))
    return float(apart.max())


def _obstacles(plant: StateSpace, place: str) -> tuple[str, ...]:
    """Return why the loop is not recovered at the `place`, however large q is."""
    zeros, sampled = structure.transmission_zeros(plant), isinstance(plant.time, Discrete)
    needed = len(plant.inputs if place == "input" else plant.outputs)
    found = []
    if zeros.rank < needed:
        found.append(f"the plant's response has rank {zeros.rank} but {needed} {place}s: no recovery at the {place}")
    for z in zeros.values:
        if z.imag >= 0 and (abs(z) > 1 - MARGIN if sampled else z.real > -MARGIN * abs(z)):
            found.append(f"the plant's zero {show.number(z)} does not decay: no recovery near it and above")
    if sampled and zeros.rank >= needed and np.linalg.matrix_rank(plant.C @ plant.B) < needed:
        found.append(
            "C B has no full rank: the plant answers later than in the next sample, which no gain makes up for"
        )
    return tuple(found)
