"""State trajectory of emitted C: x_0 from `init`, x_{k+1} = step(x_k, u_k)."""

import ctypes
from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from synth.execute import host
from synth.execute.host import Records


def states(controller: host.Controller, inputs: Mapping[str, ArrayLike]) -> Records:
    """Return the states x_0 .. x_N (N + 1,) from `init`, under input columns (N,) or constants.

    Raises SignalError as `host.Controller.replay`.
    """
    n = host.length(inputs)
    input_records = controller.records(inputs, n)
    states, outputs = np.zeros(n + 1, controller.state), np.zeros((), controller.outputs)
    states[0] = controller.init()
    step = ctypes.CFUNCTYPE(ctypes.c_uint32, *[ctypes.c_void_p] * 3)(controller.step_address)
    state_address, size = states.ctypes.data, states.itemsize
    input_address, width = input_records.ctypes.data, input_records.itemsize
    for k in range(n):
        states[k + 1] = states[k]
        step(state_address + (k + 1) * size, input_address + k * width, outputs.ctypes.data)
    return states
