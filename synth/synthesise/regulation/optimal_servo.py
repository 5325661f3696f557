"""Optimal servo regulators (cf. MATLAB `lqi`): the K of `servo` that minimises int (x'Qx + u'Ru) dt over x and xi.

In discrete time `lqr` minimises the sum. `lqrd` holds the plant's input and the error that drives xi over each period T
and minimises the same integral as in continuous time,

    int_0^T = [x; xi; u; e]' W [x; xi; u; e],   W = int_0^T M(t)' diag(Q, R, 0) M(t) dt,   e = C x + D u at the sample,

with M(t) the exponential of [[A, 0, B, 0], [0, I (x) Phi, 0, I (x) N], [0, 0, 0, 0]] t. The loop of least cost is then
exactly the sampled loop that is implemented.
"""

import numpy as np
import scipy.linalg
from numpy.typing import ArrayLike

from synth import arguments
from synth.analyse import discretise
from synth.statespace import Array, StateSpace, System
from synth.synthesise.feedback import lqr as linear_quadratic
from synth.synthesise.regulation import internal_model, servo
from synth.synthesise.regulation.internal_model import Exosystem, InternalModel
from synth.synthesise.riccati import weights
from synth.timing import Continuous, common


@arguments.checked
def lqr(
    system: System,
    exosystem: Exosystem,
    Q: weights.Weight,
    R: weights.Weight,
    N: ArrayLike | None = None,
    *,
    regulated: servo.Names = None,
    controls: servo.Names = None,
) -> servo.Servo:
    """Return the optimal state feedback of a plant in its own time.

    Q (n + p k, n + p k) weights the plant's states and `InternalModel.state_names`, R (m, m) the controls, N is the
    cross weight. Inputs that are no controls are disturbances. K is the same on every machine.

    Raises SignalError for unknown names; else as `internal_model.augmented` and `riccati.solve`.
    """
    plant, acting, model = servo.split_plant(system, exosystem, regulated, controls)
    whole = internal_model.augmented(acting, model)
    gain = linear_quadratic.lqr(whole, Q, R, N).K
    return servo.of_gain(plant, model, gain, regulated=acting.outputs, controls=acting.inputs)


@arguments.checked
def lqrd(
    system: System,
    exosystem: Exosystem,
    Q: weights.Weight,
    R: weights.Weight,
    period_s: float,
    *,
    regulated: servo.Names = None,
    controls: servo.Names = None,
) -> servo.Servo:
    """Return the optimal state feedback for a continuous plant whose input and error are held over `period_s`.

    Q and R weight the continuous integral, as for `lqr`. The result is in discrete time.

    Raises as `lqr`; TimingError for a sampled plant; ModelError as `discretise.zero_order_hold`.
    """
    plant, acting, model = servo.split_plant(system, exosystem, regulated, controls)
    common(Continuous(), plant.time)
    names = (*acting.states, *model.state_names(acting.outputs))
    Q, R = weights.semidefinite("Q", Q, names), weights.definite("R", R, acting.inputs)
    W = _period_weight(acting, model, scipy.linalg.block_diag(Q, R), period_s)
    plant, acting = (discretise.zero_order_hold(part, period_s) for part in (plant, acting))
    model, k = internal_model.in_time(model, plant.time), len(names)
    whole = internal_model.augmented(acting, model)
    gain = linear_quadratic.lqr(whole, W[:k, :k], W[k:, k:], W[:k, k:]).K
    return servo.of_gain(plant, model, gain, regulated=acting.outputs, controls=acting.inputs)


def _period_weight(acting: StateSpace, model: InternalModel, Q: Array, period_s: float) -> Array:
    """Return the cost of a period as a weight on x, xi and u at its start; Q weights x, xi and u."""
    (n, m), p, k = acting.B.shape, len(acting.outputs), len(model.Phi) * len(acting.outputs)
    A = scipy.linalg.block_diag(acting.A, np.kron(np.eye(p), model.Phi))
    B = scipy.linalg.block_diag(acting.B, np.kron(np.eye(p), model.N))
    F = np.vstack([np.hstack([A, B]), np.zeros((m + p, n + k + m + p))])
    W = discretise.gramian(F, scipy.linalg.block_diag(Q, np.zeros((p, p))), period_s).W
    held = np.vstack([np.eye(n + k + m), np.hstack([acting.C, np.zeros((p, k)), acting.D])])
    gathered = held.T @ W @ held
    return np.asarray((gathered + gathered.T) / 2)
