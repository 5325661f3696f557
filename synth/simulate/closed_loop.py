"""Simulate a plant in continuous time under compiled C in sampled time, T apart, the whole loop in C.

    x' = f(x, u(t), p) + d(x, t)                      by `substeps` steps of RK4 in each period
    m_k = encoder(h(x(kT), u_{k-1}, p))               or the override's sample
    c_k = step(state, m_k, references_k)
    u(t) = M c_{k-delay} + forcing                    for kT <= t < (k+1)T, with c_j = hold for j < 0

Wires are named from the receiving end: `sensors[controller input] = plant output` and
`actuators[plant input] = controller output`, or `= {controller output: weight, ...}` for a row of M. A hard stop is
inelastic: after each substep the position is put back and the velocity into the stop is taken out. A locked coordinate
keeps its position and velocity.
"""

import ctypes
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib import resources
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike, NDArray

from synth.emit import casadi_c
from synth.errors import SignalError, WiringError
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.plant import Plant
from synth.signals import Signal, dimension, names
from synth.simulate.sensors import Encoder, Override

Array = NDArray[np.float64]
Columns = dict[str, NDArray[Any]]

_SINGLE, _DOUBLE, _POINTER = ctypes.c_int64, ctypes.c_double, ctypes.c_void_p
_INTEGERS = ("samples", "substeps", "delay", "stops", "sensors", "commands", "single", "in_size", "out_size")
_MEMBERS = (
    *("samples", "substeps", "delay", "period", "p", "x", "locked"),
    *("stops", "stop_position", "stop_velocity", "stop_low", "stop_high", "impact"),
    *("sensors", "sensor_source", "sensor_offset", "sensor_resolution", "overridden"),
    *("commands", "command_offset", "mixing", "forcing", "waiting"),
    *("single", "step", "state", "in_size", "out_size", "in", "out", "faults", "states", "outputs", "applied"),
)
