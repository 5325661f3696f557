"""Recording of emitted C: the state before each step of a run, x_{k+1} = step(x_k, u_k) from `init`."""

import ctypes
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from synth.execute import host
from synth.execute.host import Records


def states(controller: host.Controller, inputs: Mapping[str, ArrayLike]) -> Records:
    """Return the states (N + 1,) from `init` on, under input columns (N,) or constants; the last follows the last step.

    Raises SignalError as `host.Controller.replay`.
    """
    n = host.length(inputs)
    given = controller.records(inputs, n)
    states, outputs = np.zeros(n + 1, controller.state), np.zeros((), controller.outputs)
    states[0] = controller.init()
    step = ctypes.CFUNCTYPE(ctypes.c_uint32, *[ctypes.c_void_p] * 3)(controller.step_address)
    state, given_at, size, width = states.ctypes.data, given.ctypes.data, states.itemsize, given.itemsize
    for k in range(n):
        states[k + 1] = states[k]
        step(state + (k + 1) * size, given_at + k * width, outputs.ctypes.data)
    return states
