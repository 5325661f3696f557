"""Linearisation about an operating point (MATLAB `linearize`): dx/dt = A x + B u, y = C x + D u for small deviations.

    A = df/dx, B = df/du, C = dh/dx, D = dh/du

at (x0, u0, p0), by exact differentiation of the plant's expressions.
"""

import casadi as ca
import numpy as np

from synth import arguments
from synth.analyse.operating_points import OperatingPoint
from synth.errors import SignalError
from synth.plant import Plant
from synth.signals import signal_names
from synth.statespace import StateSpace
from synth.timing import Continuous


@arguments.checked
def linearise(plant: Plant, point: OperatingPoint) -> StateSpace:
    """Return the Jacobians A (n, n), B (n, m), C (p, n), D (p, m) at `point`, in the units of the signals.

    Raises SignalError when `point` belongs to another plant, or a derivative is not finite there.
    """
    require_point(plant, point)
    x, u, p = (ca.SX.sym(s, len(v)) for s, v in (("x", point.x), ("u", point.u), ("p", point.p)))
    f, h = plant.f(x, u, p), plant.h(x, u, p)
    jacobians = [ca.jacobian(expr, arg) for expr in (f, h) for arg in (x, u)]
    at_point = ca.Function("jacobians", [x, u, p], jacobians)(point.x, point.u, point.p)
    A, B, C, D = (np.asarray(ca.DM(matrix)) for matrix in at_point)
    units = {s.name: s.unit for s in (*plant.states, *plant.inputs, *plant.outputs)}
    return StateSpace(A, B, C, D, point.states, point.inputs, signal_names(plant.outputs), Continuous(), units)


@arguments.checked
def require_point(plant: Plant, point: OperatingPoint) -> None:
    """Raise SignalError when `point` belongs to another plant."""
    if (point.states, point.inputs) != (signal_names(plant.states), signal_names(plant.inputs)):
        raise SignalError(
            f"the operating point has states {', '.join(point.states)} and inputs {', '.join(point.inputs)}, "
            f"which are not those of plant '{plant.name}': trim this plant"
        )
