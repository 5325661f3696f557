"""Linear quadratic Gaussian control (MATLAB `lqg`, `lqgreg`): the gain of `lqr` on the estimate of `kalman`, u = K x^.

                         +--> [q' = y - r] --- q ---+           q+ = q + T (y - r) in discrete time
                         |                          v
     y --(+)-------------+--> [estimator] -- x^ --> [K] ---+---> u
          ^                         ^                      |
          |                         +----------------------+
     measurement noise

The controller computes the integral states q of chosen outputs itself, without error; only the plant's states are
estimated. They are recognised among the gain's states by their names, ``<output>_integral`` as in
`lqr.with_integrators`, and add an input ``<output>_reference``. The poles of the loop are those of A + B K, with the
integrators, and those of the estimator (separation principle). Source: Anderson, Moore, Optimal Control (1990),
chapter 8.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import scipy.linalg
import scipy.optimize

from synth import arguments, show
from synth.analyse.loops import interconnect
from synth.errors import SignalError
from synth.statespace import Complex, StateSpace
from synth.synthesise.feedback import lqr
from synth.synthesise.observers import kalman
from synth.timing import Continuous, common

INTEGRAL = "_integral"


@show.result
class Controller:
    """A gain on an estimator: `compensator` from y, references and other known inputs to u, and the closed `loop`.

    The loop has the inputs ``<state>_disturbance`` (on x' or x+), ``<output>_noise``, then those of the compensator
    except y; its outputs are y and u.
    """

    gain: lqr.Gain
    estimator: kalman.Estimator
    compensator: StateSpace
    loop: StateSpace

    @property
    def poles(self) -> Complex:
        """Eigenvalues of the closed loop, in 1/s or in z."""
        return self.loop.poles

    @property
    def separation(self) -> float:
        """The largest distance of a pole of the loop from its counterpart among those of regulator and estimator.

        Relative in continuous time, absolute in z. It is small when the gain was designed for the estimator's model.
        """
        designed = np.concatenate([self.gain.poles, self.estimator.poles])
        size = np.abs(designed) if isinstance(self.loop.time, Continuous) else np.ones(len(designed))
        distances = np.abs(self.poles[:, None] - designed) / size
        return float(distances[scipy.optimize.linear_sum_assignment(distances)].max())

    def sheet(self) -> show.Sheet:
        """Return the poles of the two designs, the separation and the compensator."""
        inner = self.compensator.sheet()
        texts = [", ".join(show.number(s) for s in part.poles) for part in (self.gain, self.estimator)]
        lines = (
            f"poles of the regulator {texts[0]}; of the estimator {texts[1]}",
            f"separation: the poles of the loop lie within {self.separation:.1e} of these",
            f"compensator: {inner.title}",
        )
        title = f"LQG controller of {', '.join(self.gain.inputs)} from {', '.join(self.estimator.model.outputs)}"
        return show.Sheet(title, lines, inner.tables)


@arguments.checked
def predictor(gain: lqr.Gain, estimator: kalman.Estimator) -> Controller:
    """Return the controller whose u uses only earlier samples; a whole period is available to compute it.

    Raises TimingError for different times; SignalError when the gain's states are not the estimator's and integrals of
    its outputs, or the estimator does not know its inputs; ModelError for an algebraic loop without a solution.
    """
    return _controller(gain, estimator, estimator.predictor())


@arguments.checked
def current(gain: lqr.Gain, estimator: kalman.Estimator) -> Controller:
    """Return the controller whose u also uses the sample of the same instant. Raises as `predictor`."""
    return _controller(gain, estimator, estimator.current())


def _controller(gain: lqr.Gain, estimator: kalman.Estimator, estimator_form: StateSpace) -> Controller:
    model = estimator.model
    common(gain.time, model.time)
    regulated = integrals(gain, model)
    integrators = _integrators(model, regulated)
    others = tuple(name for name in model.inputs if name not in gain.inputs)
    external = (*model.outputs, *(f"{y}_reference" for y in regulated), *others)
    parts = (
        estimator_form,
        integrators.renamed({y: f"{y}_measured" for y in regulated}),
        _feedback(gain, estimator_form, integrators),
    )
    wires = {f"{y}_measured": {y: 1.0} for y in regulated}
    compensator = interconnect.connect(parts, external, gain.inputs, wires)
    return Controller(gain, estimator, compensator, _loop(model, compensator, others))


def _feedback(gain: lqr.Gain, estimator_form: StateSpace, integrators: StateSpace) -> StateSpace:
    """Return u = K (x^, q) as a static model."""
    names = tuple(x if x in integrators.states else f"{x}_estimate" for x in gain.states)
    m, n = gain.K.shape
    units = {**estimator_form.units, **integrators.units}
    no_states = (np.zeros((0, 0)), np.zeros((0, n)), np.zeros((m, 0)))
    return StateSpace(*no_states, gain.K, (), names, gain.inputs, gain.time, units)


def _loop(model: StateSpace, compensator: StateSpace, others: Sequence[str]) -> StateSpace:
    """Return the compensator around the plant with noise on its states and outputs."""
    n, p = model.C.T.shape
    on_states = tuple(f"{name}_disturbance" for name in model.states)
    on_outputs = tuple(f"{name}_noise" for name in model.outputs)
    known = tuple(name for name in compensator.inputs if name not in model.outputs)
    D = np.hstack([model.D, np.zeros((p, n))])
    units = {**model.units, **{f"{y}_noise": model.unit(y) for y in model.outputs if y in model.units}}
    plant = replace(model, B=np.hstack([model.B, np.eye(n)]), D=D, inputs=(*model.inputs, *on_states))
    wires = {f"{name}_measured": {name: 1.0} for name in others}
    wires |= {y: {y: 1.0, f"{y}_noise": 1.0} for y in model.outputs}
    parts = (plant, compensator.renamed({name: f"{name}_measured" for name in others}))
    outputs = (*model.outputs, *compensator.outputs)
    joined = interconnect.connect(parts, (*on_states, *on_outputs, *known), outputs, wires)
    return replace(joined, units={**units, **joined.units})


@arguments.checked
def integrals(gain: lqr.Gain, model: StateSpace) -> tuple[str, ...]:
    """Return the outputs of a model whose integrals are among the gain's states.

    Raises SignalError when the other states or the inputs are not the model's.
    """
    extra = tuple(x for x in gain.states if x not in model.states)
    outputs = tuple(x.removesuffix(INTEGRAL) for x in extra)
    missing = [x for x in model.states if x not in gain.states]
    missing += [x for x, y in zip(extra, outputs, strict=True) if y == x or y not in model.outputs]
    inputs = [u for u in gain.inputs if u not in model.inputs]
    if inputs and not missing:
        j = gain.inputs.index(inputs[0])
        raise SignalError(
            f"the input '{inputs[0]}' is not both in the gain and in the estimator's model, which has "
            f"{', '.join(model.inputs) or 'no inputs'}: if the G of the estimator names it, it counts as noise alone; "
            f"give its column of B instead, `G=B[:, [{j}]]`, and it stays an input; otherwise design the gain for that "
            "model"
        )
    if missing:
        raise SignalError(
            f"'{missing[0]}' is not both in the gain and in the estimator's model: design the gain for that model, or "
            "for `lqr.with_integrators` of it"
        )
    return outputs


def _integrators(model: StateSpace, outputs: Sequence[str]) -> StateSpace:
    """Return q' = y - r, or q+ = q + T (y - r), for some outputs, with names and units as `lqr.with_integrators`."""
    references = tuple(f"{y}_reference" for y in outputs)
    sums = interconnect.integrals(model, {f"{y}{INTEGRAL}": y for y in outputs})
    units = dict(sums.units) | {r: model.unit(y) for y, r in zip(outputs, references, strict=True) if y in model.units}
    D = np.zeros((len(outputs), 2 * len(outputs)))
    return replace(sums, B=np.hstack([sums.B, -sums.B]), D=D, inputs=(*outputs, *references), units=units)
