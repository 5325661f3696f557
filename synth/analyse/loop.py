"""Opening a sampled loop at one signal: what ships, linearised, around the plant with its hold and delay.

    u_s --> [ controller without s ] --> [ delay ] --> [ hold, plant, sampler ] --> [ controller ] --> y_s

The controller's Block is composed with the signal s cut: its driver then drives ``s_out``, its readers read ``s``. The
loop L from s to -s_out has the closed loop 1 + L.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import casadi as ca
import numpy as np

from synth.analyse import discretise, structure
from synth.block import Block
from synth.errors import SignalError
from synth.signals import names
from synth.statespace import Array, StateSpace
from synth.timing import period


def cut(blocks: Sequence[Block], signal: str) -> tuple[Block, ...]:
    """Return the Blocks with the driver of `signal` renamed to ``<signal>_out``.

    Raises SignalError when no Block drives it.
    """
    out = f"{signal}_out"
    if not any(signal in names(b.outputs) for b in blocks):
        raise SignalError(f"no Block drives '{signal}': open the loop at a signal that one drives")
    return tuple(_renamed(b, signal, out) if signal in names(b.outputs) else b for b in blocks)


def _renamed(block: Block, old: str, new: str) -> Block:
    outputs = tuple(replace(s, name=new) if s.name == old else s for s in block.outputs)
    inside = tuple(
        (replace(n, signal=replace(n.signal, name=new)) if n.signal.name == old else n, e) for n, e in block.inside
    )
    output = {new if n == old else n: e for n, e in block.output.items()}
    faults = tuple(replace(f, output=new) if f.output == old else f for f in block.faults)
    return replace(block, outputs=outputs, inside=inside, output=output, faults=faults)


def linearised(block: Block, state: Mapping[str, float], inputs: Mapping[str, float]) -> StateSpace:
    """Return the Block's Jacobians at a state and inputs, by name; a state that is not given is at its initial value.

    Raises SignalError for a value missing or a name not known.
    """
    known = (*(s.name for s in block.states), *names(block.inputs))
    unknown = [n for n in (*state, *inputs) if n not in known]
    missing = [n for n in names(block.inputs) if n not in inputs]
    if unknown or missing:
        raise SignalError(f"block '{block.name}': not known {unknown or 'none'}, missing {missing or 'none'}")
    f = block.function()
    x, u = f.sx_in()
    next, y = f.call([x, u])
    jacobians = [ca.densify(ca.jacobian(e, a)) for e in (next, y) for a in (x, u)]
    x0 = [state.get(s.name, s.initial) for s in block.states]
    u0 = [inputs[n] for n in names(block.inputs)]
    A, B, C, D = (np.asarray(ca.DM(m)) for m in ca.Function("jacobians", [x, u], jacobians)(x0, u0))
    states = tuple(s.name for s in block.states)
    return StateSpace(A, B, C, D, states, names(block.inputs), names(block.outputs), block.time)


def opened(
    plant: StateSpace,
    controller: StateSpace,
    signal: str,
    sensors: Mapping[str, str],
    actuators: Mapping[str, str],
    delay: int = 1,
) -> StateSpace:
    """Return L from `signal` to minus ``<signal>_out``: the continuous plant held and sampled under the controller.

    `sensors[controller input] = plant output`, `actuators[plant input] = controller output`; other controller inputs
    stay at rest.

    Raises TimingError for a sampled plant or a continuous controller; SignalError for a name that is not known, or
    when without a delay the plant passes its inputs straight on.
    """
    P = discretise.with_delay(discretise.zero_order_hold(plant, period(controller.time)), delay)
    K = controller
    if (P.D != 0).any():
        raise SignalError("the sampled plant passes inputs straight on: give the loop at least one sample of delay")
    S = _wires(K.inputs, P.outputs, sensors)
    U = _wires(P.inputs, K.outputs, actuators)
    e = _wires(K.inputs, (signal,), {signal: signal})
    y = _wires(("out",), K.outputs, {"out": f"{signal}_out"})
    A = np.block([[P.A + P.B @ U @ K.D @ S @ P.C, P.B @ U @ K.C], [K.B @ S @ P.C, K.A]])
    B = np.vstack([P.B @ U @ K.D @ e, K.B @ e])
    C = -np.hstack([y @ K.D @ S @ P.C, y @ K.C])
    D = -y @ K.D @ e
    states = tuple(f"plant_{s}" for s in P.states) + K.states
    return structure.connected(StateSpace(A, B, C, D, states, (signal,), (f"{signal}_out",), controller.time))


def _wires(into: Sequence[str], source: Sequence[str], wires: Mapping[str, str]) -> Array:
    """Return the matrix (into, source) of zeros with a one for each wire."""
    W = np.zeros((len(into), len(source)))
    for end, start in wires.items():
        for name, known in ((end, into), (start, source)):
            if name not in known:
                raise SignalError(f"the wire from '{start}' to '{end}': '{name}' is not one of {', '.join(known)}")
        W[into.index(end), source.index(start)] = 1
    return W
