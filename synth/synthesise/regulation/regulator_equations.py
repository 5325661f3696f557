"""Solvability of the regulator equations (Francis 1977): a steady state in which the regulated outputs have no error.

    w' = S w        x' = A x + B u + E w        e = C x + D u + F w           (x+ and w+ in discrete time)

    Pi S = A Pi + B Gamma + E,    0 = C Pi + D Gamma + F

for A (n, n), B (n, m), C (p, n), S (q, q), E (n, q), F (p, q). On x = Pi w, u = Gamma w the error is zero.

A solution exists for all E and F when no mode s of S is a transmission zero: the Rosenbrock matrix
[[A - s I, B], [C, D]] must have full row rank n + p. If it has not, its left null vector (v, y) gives the combination
y^H e of the errors that no input affects at s.
"""

from collections.abc import Sequence

import numpy as np

from synth import arguments, show
from synth.analyse.numerics.equilibrate import equilibrated
from synth.analyse.structure import staircase, structure
from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.synthesise.regulation import minimal_polynomial
from synth.timing import Continuous, Time


@arguments.checked
def require_solvable(model: StateSpace, modes: Sequence[minimal_polynomial.Mode]) -> None:
    """Raise ModelError, with the reason, unless the model's inputs can regulate all its outputs at all `modes`.

    The conditions are at least as many inputs as outputs, stabilisability, and no transmission zero at a mode of the
    exosystem (in 1/s, also for a sampled model).
    """
    if len(model.inputs) < len(model.outputs):
        raise ModelError(
            f"{len(model.outputs)} outputs ({', '.join(model.outputs)}) cannot be regulated by {len(model.inputs)} "
            f"inputs ({', '.join(model.inputs)}): regulate fewer or add actuators"
        )
    structure.check_stabilisable(model)
    require_no_zero(model, [_point(mode.value, model.time) for mode in modes])


@arguments.checked
def require_no_zero(model: StateSpace, points: Sequence[complex]) -> None:
    """Raise ModelError for a transmission zero at one of the `points`, in 1/s or in z, naming the blocked outputs."""
    for point in points:
        blocked = _blocked_outputs(model, point)
        if blocked is not None:
            raise ModelError(
                f"the plant from {', '.join(model.inputs)} to {', '.join(model.outputs)} has a transmission zero at "
                f"{_mode_text(point, model.time)} of the exosystem: it cannot be regulated there, as no input affects "
                f"{structure.direction_text(blocked)}; drop it, regulate other outputs or change the actuators"
            )


def _point(s: complex, time: Time) -> complex:
    return complex(s) if isinstance(time, Continuous) else complex(np.exp(s * time.period_s))


def _mode_text(point: complex, time: Time) -> str:
    s = point if isinstance(time, Continuous) else np.log(point) / time.period_s
    if abs(s.real) <= 1e-9 * abs(s):
        return f"{abs(s.imag):g} rad/s, a frequency"
    return f"{show.number(s)} 1/s, a mode"


def _blocked_outputs(model: StateSpace, point: complex) -> dict[str, complex] | None:
    """Return the combination of outputs that no input affects at a point, None when there is none."""
    n = len(model.A)
    R, rows, _ = equilibrated(np.block([[model.A - point * np.eye(n), model.B], [model.C, model.D]]))
    U, sigma, _ = np.linalg.svd(R)
    if len(sigma) == len(R) and sigma[-1] > staircase.COUPLING * sigma[0]:
        return None
    return structure.direction(np.asarray((rows * U[:, -1].conj())[n:], dtype=np.complex128), model.outputs)
