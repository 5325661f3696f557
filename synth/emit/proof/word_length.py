"""Finite word length: what rounding to the scalar type does to the linear parts of a law.

    x+ = A x + B u,   y = C x + D u        once exact, once with each coefficient as the C has it

A part is a set of states that depend on each other by linear terms (a strongly connected component); u is what else is
added to them, and y the signals that are linear in them. Of a limit the inside counts. Of a choice between next states
the arm with more terms counts, for the other one holds, and of any other choice that with fewer, for the other starts.

    DC gain     C (I - A)^-1 B + D, of the pair (u, y) where it changes most
    poles       eigenvalues z of A, of which |z' - z| / |1 - z| says how far one moves, relative to its frequency
    amplitude   |z'|^n of an oscillation, |z| = 1, is left after n samples
    dead band   an increment of x_i below half a unit in the last place of x_i is lost. An integrator therefore rests
                while |b_ij u_j| is below it. Other states rest within |(I - A)^-1| r, r_i half a unit for each term.

Source: Franklin, Powell, Workman, Digital Control of Dynamic Systems, chapter 10 (quantisation effects).
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import matrix_balance
from scipy.optimize import linear_sum_assignment
from scipy.sparse.csgraph import connected_components

from synth import resolvent
from synth.block import Block
from synth.emit.program.lower import OPERATIONS, Node, Program
from synth.emit.proof import conditions
from synth.errors import EmitError
from synth.signals import Signal

HOUR = 3600.0  # s
GAIN_ERROR = 0.01  # default largest relative change of a DC gain
NO_GAIN = 1e-9  # of the largest gain at POINTS: a smaller DC gain is 0 by design
POINTS = np.exp(1j * np.pi * np.geomspace(1e-5, 1, 64))  # up to half the sample rate
SINGULAR = 1e13  # condition of I - A from which on z = 1 is a pole
NOTABLE = 1e-3  # smallest relative change of which a summary speaks
STEADY = 1e-9  # largest ||z| - 1| of an oscillation
_NUMBER = -1
_ARMS = {"choose": slice(1, None), "when": slice(1, None), "clamp": slice(1), "within": slice(1)}
_ARMS |= {"min": slice(None), "max": slice(None)}

Array = NDArray[np.float64]
Form = Mapping[int, float]  # the factor of each node, and a number


@dataclass(frozen=True)
class DCGain:
    """The DC gain from `input` to `output`, names or expressions: the exact one, and that of the C."""

    input: str
    output: str
    exact: float
    rounded: float

    @property
    def error(self) -> float:
        """The relative change."""
        return abs(self.rounded / self.exact - 1)


@dataclass(frozen=True)
class LinearPart:
    """Linear dynamics between `states`, and what the scalar type does to them.

    `gain` is None at an integrator and where it is 0. `pole` in z is the one that moves most, to `rounded_pole`, by the
    relative `shift`, infinite for an integrator that leaks; where some become unstable, it is one of these. `amplitude`
    is what is left of an oscillation after an hour, else None. `lost` is what the `input` of an integrator must exceed
    where the state `at` is at its bound; the input is `at`, for an increment of it, where none has a name. For other
    parts `input` is None, and the state `at`
    may rest as far as `lost` from its exact value.
    """

    states: tuple[str, ...]
    period_s: float
    gain: DCGain | None
    pole: complex
    rounded_pole: complex
    shift: float
    amplitude: float | None
    at: Signal
    lost: float
    input: Signal | None

    def sentence(self) -> str:
        """Return the figures that matter, "" if none does."""
        texts = []
        if self.shift > NOTABLE:
            before, after = (_frequency(z, self.period_s) for z in (self.pole, self.rounded_pole))
            texts.append(f"pole at {after} instead of {before}")
        if self.amplitude is not None and abs(self.amplitude - 1) > NOTABLE:
            texts.append(f"after an hour {self.amplitude:.5g} of an oscillation is left")
        if (g := self.gain) and not g.error <= NOTABLE:
            texts.append(f"DC gain from {g.input} to {g.output} {g.rounded:.6g} instead of {g.exact:.6g}")
        if (u := self.input) is not None:
            name = "increment" if u is self.at else u.name
            texts.append(f"no {name} below {self.lost:.2g} {u.unit} is integrated at the bound of {self.at.name}")
        elif self.lost > NOTABLE * max(abs(self.at.low), abs(self.at.high)):
            texts.append(f"at the bounds {self.at.name} may rest {self.lost:.2g} {self.at.unit} off its exact value")
        return f"{', '.join(self.states)}: {'; '.join(texts)}" if texts else ""


def _frequency(z: complex, period_s: float) -> str:
    if z in (0, 1):
        return f"z = {z.real:g}"
    s = np.log(complex(z)) / period_s
    return f"{abs(s) / (2 * np.pi):.6g} Hz with damping {round(-s.real / abs(s), 9) + 0.0:.4g}"


def summary(parts: Sequence[LinearPart], scalar: str) -> list[str]:
    """Return what a designer must know of the linear parts in a scalar type, a line each; nothing without parts."""
    gains = max((p.gain.error for p in parts if p.gain), default=0.0)
    shift = max((p.shift for p in parts if p.shift < np.inf), default=0.0)
    first = f"{scalar} changes DC gains by at most {gains:.2g} and poles by at most {shift:.2g}"
    return [first, *filter(None, (p.sentence() for p in parts))] if parts else []


def linear_parts(program: Program, block: Block, scalar: type[np.floating]) -> tuple[LinearPart, ...]:
    """Return the linear parts of the program of a Block, which has exact constants, in the order of its states.

    Constants that may change have their declared values.
    """
    nodes = (replace(n, op="constant") if n.name in block.tunable else n for n in program.nodes)
    next_states = {name: k for name, k in program.next.items() if name not in block.tunable}
    program = replace(program, nodes=tuple(nodes), next=next_states)
    exact = _forms(program, _constants(block), float)
    rounded = _forms(program, _constants(block.rounded(scalar)), lambda v: float(scalar(v)))
    state_nodes = {n.name: k for k, n in enumerate(program.nodes) if n.op == "state" and n.name not in program.integers}
    signals = [s.signal for s in block.states if s.name in state_nodes]
    declared = {s.name: s for s in (*block.inputs, *signals)}
    named = {k: declared[n.name] for k, n in enumerate(program.nodes) if n.name in declared}
    named |= {k: mark.signal for mark, k in reversed(program.marks)}
    next = _next(program, exact), _next(program, rounded)
    links = _matrix([next[0][s.name] for s in signals], [state_nodes[s.name] for s in signals])
    labels = connected_components(links != 0, connection="strong")[1].tolist()
    parts = []
    for label in dict.fromkeys(labels):
        inside = [k for k, other in enumerate(labels) if other == label]
        if links[np.ix_(inside, inside)].any():
            states = {state_nodes[signals[k].name]: signals[k] for k in inside}
            parts.append(_part(program, block.time.period_s, (exact, rounded), next, states, named, scalar))
    return tuple(parts)


def _constants(block: Block) -> dict[str, float]:
    """Return the constants of a Block, with the declared values of those that may change."""
    held = {s.name: s.initial for s in block.states if s.name in block.tunable}
    return {c.name: c.value for c in block.constants} | held


def _part(
    program: Program,
    period_s: float,
    forms: tuple[Sequence[Form], Sequence[Form]],
    next: tuple[Mapping[str, Form], Mapping[str, Form]],
    states: Mapping[int, Signal],
    named: Mapping[int, Signal],
    scalar: type[np.floating],
) -> LinearPart:
    """Return the part of `states`, from exact and rounded `forms` of nodes and `next` states; signals are by node."""
    signals, columns = [*states.values()], [*states]
    rows = [[n[s.name] for s in signals] for n in next]
    read = sorted({j for row in rows[0] for j in row} - {*columns, _NUMBER})
    shown = [k for _, k in program.marks if not forms[0][k].keys().isdisjoint(columns)] or columns
    models = [
        tuple(_matrix(r, c) for r in (of_states, [f[k] for k in shown]) for c in (columns, read))
        for of_states, f in zip(rows, forms, strict=True)
    ]
    (A, B, _, _), (rounded_A, _, _, _) = models
    z, rounded_z = np.linalg.eigvals(A), np.linalg.eigvals(rounded_A)
    rounded_z = rounded_z[linear_sum_assignment(np.abs(z[:, None] - rounded_z))[1]]
    moved, far = np.abs(rounded_z - z), np.abs(1 - z)
    shift = np.divide(moved, far, out=np.where(moved > 0, np.inf, 0.0), where=far > 0)
    is_sound = (np.abs(z) >= 1 - STEADY) | (np.abs(rounded_z) <= 1)
    k = int(np.lexsort((-shift, is_sound))[0])
    oscillates = (np.abs(np.abs(z) - 1) < STEADY) & (z.imag != 0)
    amplitude = min((np.abs(rounded_z[oscillates]) ** (HOUR / period_s)).tolist(), default=None)
    largest = [np.nextafter(scalar(max(abs(s.low), abs(s.high))), scalar(0)) for s in signals]
    half = np.array([np.spacing(v) for v in largest], dtype=np.float64) / 2
    if np.linalg.cond(np.eye(len(A)) - matrix_balance(A, permute=False)[0]) < SINGULAR:
        gain = _largest_change([_name(program, j) for j in read], [_name(program, j) for j in shown], *models)
        rest = np.abs(np.linalg.inv(np.eye(len(A)) - A)) @ ([len(row) for row in rows[0]] * half)
        rest = rest if (np.abs(z) < 1 - STEADY).all() else 0 * rest
        i = int((rest / half).argmax())
        lost, input = rest[i], None
    else:
        sizes = [(half[i] / abs(b), i, read[j]) for (i, j), b in np.ndenumerate(B) if b and read[j] in named]
        gain, (lost, i, j) = None, min(sizes, default=(half[0], 0, columns[0]))
        input = named[j] if sizes else signals[i]
    poles = complex(z[k]), complex(rounded_z[k]), float(shift[k])
    return LinearPart(tuple(s.name for s in signals), period_s, gain, *poles, amplitude, signals[i], float(lost), input)


def _largest_change(
    inputs: Sequence[str], outputs: Sequence[str], exact: Sequence[Array], rounded: Sequence[Array]
) -> DCGain | None:
    """Return the DC gain that changes most between two models (A, B, C, D), None where all are 0."""
    A, B, C, D = exact
    peak = np.abs(resolvent.response(A, B, C, D, POINTS)).max(axis=0)
    before, after = (m[3] + m[2] @ _solve(np.eye(len(m[0])) - m[0], m[1]) for m in (exact, rounded))
    candidates = [
        DCGain(inputs[j], outputs[i], float(before[i, j]), float(after[i, j]))
        for i, j in np.argwhere(np.abs(before) > NO_GAIN * peak)
    ]
    return max(candidates, key=lambda g: np.nan_to_num(g.error, nan=np.inf), default=None)


def _solve(matrix: Array, sides: Array) -> Array:
    try:
        return np.asarray(np.linalg.solve(matrix, sides), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.full(sides.shape, np.inf)


def _name(program: Program, k: int) -> str:
    return conditions.expression(program, k, spelled=False)


def _matrix(rows: Sequence[Form], columns: Sequence[int]) -> Array:
    """Return the factors (rows, columns) of nodes in forms."""
    return np.array([[row.get(j, 0.0) for j in columns] for row in rows]).reshape(len(rows), len(columns))


def _forms(program: Program, constants: Mapping[str, float], rounded: Callable[[float], float]) -> list[Form]:
    """Return each node as a linear form; one that is none of others is a form of itself.

    Literals, products of `constants` and operations on numbers are `rounded`.
    """
    values = dict(constants)
    for name, (first, second) in program.products.items():
        values[name] = rounded(values[first] * values[second])
    forms: list[Form] = []
    for k, node in enumerate(program.nodes):
        form = _form(node, [forms[a] for a in node.args], values, rounded)
        form = _row(program, node, forms, values, rounded) if node.op == "row" else form
        forms.append({k: 1.0} if form is None else form)
    return forms


def _row(
    program: Program, node: Node, forms: Sequence[Form], values: Mapping[str, float], rounded: Callable[[float], float]
) -> Form:
    """Return a row of a product with a matrix as a linear form."""
    product, form = program.nodes[node.args[0]], dict[int, float]()
    row = program.matrices[product.name].coefficients[int(node.value)]
    for c, a in zip(row, product.args, strict=True):
        factor = values[c.name] if c.op == "constant" else rounded(c.value)
        form |= {j: form.get(j, 0.0) + factor * v for j, v in forms[a].items()} if factor else {}
    return form


def _form(
    node: Node, args: Sequence[Form], values: Mapping[str, float], rounded: Callable[[float], float]
) -> Form | None:
    """Return a node as a linear form of earlier ones, from those of its arguments; None where it is none."""
    numbers = [a[_NUMBER] for a in args if a.keys() == {_NUMBER}]
    if node.op == "constant":
        return {_NUMBER: values[node.name]}
    if node.op == "literal":
        return {_NUMBER: rounded(node.value)}
    if args and len(numbers) == len(args) and node.op in OPERATIONS:
        return {_NUMBER: rounded(float(OPERATIONS[node.op](*numbers)))}
    if node.op in ("add", "sub"):
        sign = 1.0 if node.op == "add" else -1.0
        return {j: args[0].get(j, 0.0) + sign * args[1].get(j, 0.0) for j in {**args[0], **args[1]}}
    factor = {"neg": -1.0, "twice": 2.0, "mul": numbers[0] if numbers else None}.get(node.op)
    if node.op == "div" and args[1].keys() == {_NUMBER}:
        factor = 1 / args[1][_NUMBER]
    if factor is not None:
        varying = next(a for a in args if a.keys() != {_NUMBER})
        return {j: factor * v for j, v in varying.items()}
    return _arm(args[_ARMS[node.op]], 1) if node.op in _ARMS else None


def _arm(arms: Sequence[Form], sign: int) -> Form | None:
    """Return the arm with the fewest terms, or the most for a negative `sign`, but no number if there is another."""
    varying = sorted((a for a in arms if a.keys() != {_NUMBER}), key=lambda a: sign * len(a))
    ambiguous = len(varying) > 1 and len(varying[0]) == len(varying[1]) and varying[0] != varying[1]
    return None if ambiguous or not varying else varying[0]


def _next(program: Program, forms: Sequence[Form]) -> dict[str, Form]:
    """Return the next states as linear forms."""
    advanced: list[Form] = []
    for k, node in enumerate(program.nodes):
        arm = _arm([advanced[a] for a in node.args[_ARMS[node.op]]], -1) if node.op in _ARMS else None
        advanced.append(forms[k] if arm is None else arm)
    return {name: advanced[k] for name, k in program.next.items()}


def require_gains(parts: Sequence[LinearPart], allowed: float, scalar: type[np.floating]) -> None:
    """Raise EmitError, by name, for a DC gain whose relative change is not at most `allowed`.

    So for a stable pole that moves by more, relative to its frequency, and becomes unstable.
    """
    modal = "in modal form, [[a, b], [-b, a]] for the poles a +- ib, as `biquad.block` does, or at a lower rate"
    for part in parts:
        names = ", ".join(part.states)
        if abs(part.pole) < 1 - STEADY and abs(part.rounded_pole) > 1 and part.shift > allowed:
            raise EmitError(
                f"the states {names} have a pole with |z| = {abs(part.pole):.6g}, but with the coefficients of "
                f"{np.dtype(scalar).name} {abs(part.rounded_pole):.6g}, which is unstable: write them {modal}, or "
                "emit float64"
            )
        if (g := part.gain) and not g.error <= allowed:
            raise EmitError(
                f"the DC gain from '{g.input}' to '{g.output}' is {g.exact:.6g}, but with the coefficients of "
                f"{np.dtype(scalar).name} {g.rounded:.6g}, a change of {g.error:.2g} where {allowed:g} is allowed: "
                f"write the states {names} {modal}, emit float64, or declare another `gain_error`"
            )
