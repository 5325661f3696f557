"""Localisation of a disagreement: the first signal of a law that an independent implementation of it does not have.

    law        y = h(x, u), x' = f(x, u) as CasADi's graph; its nodes are outputs of Blocks and labels of their laws
    witness    the same step by another program, of which the variables of its functions are known if it is in Python

No reference imports the toolkit, so its variables are read while it runs; nothing but this report has their names.
A node and a variable are the same signal where their values agree in each of SAMPLES steps. A walk from a result that
differs towards the inputs ends at such nodes, at states and at inputs; what it passes holds the error. Slopes of the
result along each state and input, by central differences of both programs, show a factor, a sign or a missing term.
"""

import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from itertools import combinations
from types import FrameType
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth import show
from synth.base import column_maps
from synth.block import Block
from synth.fault import Fault
from synth.verify import agree
from synth.verify.agree import Columns, Floor, StepResults, Witness

SAMPLES = 64  # steps in which a variable must equal a signal
EQUAL = 1e-9  # of the largest magnitude of a signal in these steps
MOSTLY = 0.75  # of the steps: a variable that equals a signal in so many of them, but not in the worst, is meant for it
STEP = 1e-6  # of the range: half the distance of a central difference
SLOPE = 1e-3  # relative difference of two slopes
LEAST_SLOPE = 1e-6  # of the largest change that any state or input makes over its range
LIBRARIES = sys.stdlib_module_names - {"__main__"} | {"casadi", "numpy"}  # their variables hold any call's arguments
LARGEST = float(np.finfo(np.float64).max)
DEPTH = 3  # of containers in containers of a variable
VARIABLES, VALUES = 5000, 9  # of a witness in Python: columns, and those of one variable, that are kept
NAMED, RESULTS = 8, 3  # values that a sentence names, and results whose slopes are computed
FAULTS = "fault word"
OF_TOOLKIT = "{} differs from the Block that it was made from: a defect of the toolkit or of a compiler, not of the law"


@dataclass(frozen=True)
class Result:
    """An output or a next state that differs, by the law, by the C in double precision and by the witness."""

    name: str
    law: float
    c64: float
    witness: float


@dataclass(frozen=True)
class LawSignal:
    """A signal of the law between the inputs and what differs, its Block, its value and the variable that is equal."""

    name: str
    block: str
    law: float
    variable: str


@dataclass(frozen=True)
class Slope:
    """The derivative of a result along a state or an input, by the law and by the witness."""

    result: str
    along: str
    law: float
    witness: float


@show.with_repr
@dataclass(frozen=True, repr=False)
class Disagreement:
    """The worst step in which a witness differs from the law: what it reads, its results, and where they part.

    The worst step is one without a fault and within all limits, if there is one. `inputs` and `states` are those on
    which the results depend, `signals` lie between them and the results, and `notes` are sentences.
    """

    what: str
    witness: str
    sample: int
    inputs: Mapping[str, float]
    states: Mapping[str, float]
    results: tuple[Result, ...]
    signals: tuple[LawSignal, ...]
    slopes: tuple[Slope, ...]
    notes: tuple[str, ...]

    def sheet(self) -> show.Sheet:
        """Return the sentences, and the tables of results, signals, slopes, inputs and states."""
        results = tuple((r.name, r.law, r.c64, r.witness) for r in self.results)
        signals = tuple((s.name, s.block, s.law, s.variable or "none") for s in self.signals)
        slopes = tuple((s.result, s.along, s.law, s.witness) for s in self.slopes)
        reads = tuple((name, value) for name, value in (*self.inputs.items(), *self.states.items()))
        tables = (
            show.Table("results that differ", ("result", "law", "c64", self.witness), results, 9),
            show.Table("from the inputs to them", ("signal", "block", "law", "equal variable"), signals, 9),
            show.Table("slopes that differ", ("of", "along", "law", self.witness), slopes, 6),
            show.Table("inputs and states of this step", ("name", "value"), reads, 9),
        )
        title = f"{self.what}, sample {self.sample}: {self.witness} against the law"
        return show.Sheet(title, self.notes, tuple(t for t in tables if t.rows))


@dataclass(frozen=True, eq=False)
class _Signals:
    """Named nodes of the law's graph in the order of data flow, their Blocks, expressions and values (n, SAMPLES)."""

    labels: list[str]
    blocks: list[str]
    exprs: list[ca.SX]
    values: NDArray[np.float64]
    results: dict[str, ca.SX]


def localise(
    what: str,
    name: str,
    block: Block,
    by_name: Mapping[str, Witness],
    steps: tuple[Columns, Columns],
    floor: Floor,
    tolerance: float,
) -> Disagreement | None:
    """Return where the witness `name` departs from the law over N steps (states, inputs), None where it does not.

    The law is the witness "casadi" of `by_name`; it is compared with "c64" where `name` is "casadi".
    """
    if not {"casadi", "c64"} <= set(by_name):
        return None
    witness = "c64" if name == "casadi" else name
    states, inputs = steps
    law, other = by_name["casadi"](states, inputs), by_name[witness](states, inputs)
    differing = _differing(law, other, floor, block, tolerance)
    worst = np.max([*differing.values()], axis=0)
    if not worst.any():
        return None
    calm = _within_limits(block, law) & _within_limits(block, other) & (law.faults == 0)
    sample = int(np.argmax(worst * calm if (worst * calm).any() else worst))
    n = len(worst)
    beside = [*np.flatnonzero((worst > 0) & calm)[: SAMPLES // 2], *np.linspace(0, n - 1, min(n, SAMPLES)).astype(int)]
    chosen = np.array([sample, *beside][:SAMPLES])
    x = {s.name: np.asarray(states[s.name], dtype=np.float64)[chosen] for s in block.states}
    u = {s.name: np.asarray(inputs[s.name], dtype=np.float64)[chosen] for s in block.inputs}
    first, second = (_results(_select(r, chosen)) for r in (law, other))
    signals = _signals(block, x, u)
    names = _in_order([k for k, size in differing.items() if size[sample]], signals)
    variables = _variables(by_name[witness], x, u) if witness == "reference" else {}
    equal, meant = _pairs(signals.values, variables)
    distinct = _distinct(names, first)
    words = int(law.faults[sample]), int(other.faults[sample])
    bits = [f for f in block.faults if (words[0] ^ words[1]) >> f.bit & 1]
    ends = [signals.results[k] for k in distinct[:RESULTS] or [f.output for f in bits]]
    path, agreed = _path(block, signals, ends, equal, (x, u))
    reads = {s.element_hash() for k in names if k in signals.results for s in ca.symvar(signals.results[k])}
    read = [n for n in (*u, *x) if block.symbol[n].element_hash() in reads or not reads]
    c64 = _results(by_name["c64"](x, u))
    at_one = {k: v[:1] for k, v in x.items()}, {k: v[:1] for k, v in u.items()}
    whole = {s.name for s in block.states if s.integer}
    known = {signals.labels[i]: signals.values[i] for i in path if equal[i]} | {
        n: {**u, **x}[n] for n in agreed if n not in whole
    }
    known |= {k: first[k] for k in first if not differing[k][chosen].any()}
    plain = (worst > 0)[chosen] & calm[chosen]
    notes = [
        *([_place(block, signals, ends[0], names[0], equal, (x, u))] if variables and ends else []),
        *([] if variables else [OF_TOOLKIT.format(witness)]),
        *(f"'{signals.labels[i]}' is {variables[meant[i]][0]:.9g} as {meant[i]}" for i in path if meant[i]),
        *_of_values(block, distinct, first, second, {**u, **x, **first}, plain if plain.any() else ~plain, witness),
        *(
            text
            for k in distinct[:RESULTS]
            if (text := _terms(k, (second[k] - first[k])[plain], known, plain, witness))
        ),
        *_of_faults(block, bits, words, witness),
    ]
    return Disagreement(
        what,
        witness,
        sample,
        {k: float(u[k][0]) for k in read if k in u},
        {k: float(x[k][0]) for k in read if k in x},
        tuple(Result(k, float(first[k][0]), float(c64[k][0]), float(second[k][0])) for k in names),
        tuple(LawSignal(signals.labels[i], signals.blocks[i], float(signals.values[i, 0]), equal[i]) for i in path),
        tuple(_slopes(block, distinct[:RESULTS], (by_name["casadi"], by_name[witness]), at_one)),
        tuple(dict.fromkeys(notes)),
    )


def _differing(
    law: StepResults, other: StepResults, floor: Floor, block: Block, tolerance: float
) -> dict[str, NDArray[np.float64]]:
    """Return how far each result differs in each step (N,), 0 where it agrees to the tolerance."""
    outputs, states = agree.differences(law, other, floor, block)
    words = (np.asarray(law.faults) != np.asarray(other.faults)).astype(np.float64)
    sizes = {**outputs, **{f"next {k}": v for k, v in states.items()}, FAULTS: words}
    return {k: np.where(v <= tolerance, 0.0, np.nan_to_num(v, nan=LARGEST)) for k, v in sizes.items()}


def _within_limits(block: Block, results: StepResults) -> NDArray[np.bool_]:
    """Return for each step whether no output and no real next state is at an end of its range."""
    real = [(s.signal, results.states[s.name]) for s in block.states if not s.integer]
    pairs = [(s, results.outputs[s.name]) for s in block.outputs] + real
    inside = [(v > s.low) & (v < s.high) for s, v in pairs if s.name not in _flags(block)]
    return np.all(inside, axis=0) if inside else np.ones(len(results.faults), dtype=bool)


def _flags(block: Block) -> set[str]:
    """Return outputs that are whole numbers at their ends most of the time: those of the fault word."""
    return {f.output for f in block.faults}


def _in_order(names: Sequence[str], signals: _Signals) -> list[str]:
    """Return the results in the order of data flow."""
    return sorted(names, key=lambda k: ca.n_nodes(signals.results[k]) if k in signals.results else sys.maxsize)


def _distinct(names: Sequence[str], law: Columns) -> list[str]:
    """Return the names of results whose columns differ from those before."""
    distinct = [k for i, k in enumerate(names) if not any(np.array_equal(law[k], law[n]) for n in names[:i])]
    return [k for k in distinct if k != FAULTS]


def _select(results: StepResults, chosen: NDArray[np.intp]) -> StepResults:
    outputs, states = ({k: v[chosen] for k, v in c.items()} for c in (results.outputs, results.states))
    return StepResults(outputs, states, results.faults[chosen])


def _results(results: StepResults) -> dict[str, NDArray[np.float64]]:
    """Return outputs, next states and fault words (N,) under the names of a Disagreement."""
    next_states = {f"next {k}": v for k, v in results.states.items()}
    every = {**results.outputs, **next_states, FAULTS: results.faults}
    return {k: np.asarray(v, dtype=np.float64) for k, v in every.items()}


def _signals(block: Block, x: Columns, u: Columns) -> _Signals:
    """Return the named nodes of the law's graph with their values; a node follows those that it contains."""
    named = [(s.signal.name, s.block, e) for s, e in block.computed_signals]
    named += [(name, "", e) for name, e in block.labels]
    results = {**block.output, **{f"next {k}": e for k, e in block.next.items()}}
    symbols, values = [block.symbol[c.name] for c in block.constants], [ca.SX(c.value) for c in block.constants]
    exprs = [ca.densify(e) for e in (*(e for _, _, e in named), *results.values())]
    exprs = ca.cse(ca.substitute(exprs, symbols, values) if symbols else exprs)
    nodes, ends = exprs[: len(named)], dict(zip(results, exprs[len(named) :], strict=True))
    order = sorted(range(len(named)), key=lambda i: ca.n_nodes(nodes[i]))
    seen: dict[int, int] = {}
    for i in order:  # the first name of a node; constants and copies of inputs are no signals
        if not (nodes[i].is_constant() or nodes[i].is_symbolic()):
            seen.setdefault(nodes[i].element_hash(), i)
    order = list(seen.values())
    nodes = [nodes[i] for i in order]
    return _Signals(
        [named[i][0] for i in order], [named[i][1] for i in order], nodes, _evaluate(block, nodes, x, u), ends
    )


def _evaluate(block: Block, exprs: Sequence[ca.SX], x: Columns, u: Columns) -> NDArray[np.float64]:
    """Return the values (m, N) of expressions at N steps."""
    groups = ([s.name for s in block.states], x), ([s.name for s in block.inputs], u)
    arguments = [ca.vcat([block.symbol[n] for n in names]) for names, _ in groups]
    size = len(next(iter((x or u).values())))
    columns = [np.array([c[n] for n in names], dtype=np.float64).reshape(len(names), size) for names, c in groups]
    (values,) = column_maps.map_columns(ca.Function("values", arguments, [ca.vcat(exprs)]), *columns)
    return values


def _variables(witness: Witness, x: Columns, u: Columns) -> dict[str, NDArray[np.float64]]:
    """Return the columns (n,) that variables of a witness in Python hold as its functions run, those of callers first.

    A variable that is bound again, as in a loop, has a number behind its name from its second value on.
    """
    n, columns = len(next(iter(u.values()))), dict[str, NDArray[np.float64]]()
    bound: dict[FrameType, dict[str, Any]] = {}

    def at_line(frame: FrameType, event: str, _: object) -> Any:
        before = bound.setdefault(frame, {})
        for variable, held in frame.f_locals.items() if len(columns) < VARIABLES else ():
            if held is not before.get(variable) or event == "return":  # an item may be put into what is bound already
                before[variable] = held
                for name, column in _columns(variable, held, n, DEPTH):
                    _add(columns, f"{frame.f_code.co_name}: {name}", column)
        return at_line

    def at_call(frame: FrameType, event: str, _: object) -> Any:
        return at_line if _is_of_witness(frame) else None

    tracer = sys.gettrace()
    sys.settrace(at_call)
    try:
        witness(x, u)
    finally:
        sys.settrace(tracer)
    return dict(reversed(columns.items()))


def _add(columns: dict[str, NDArray[np.float64]], name: str, column: NDArray[np.float64]) -> None:
    """Add a column under its name, with a number where that name has other values."""
    for k in range(1, VALUES + 1):
        numbered = f"{name} ({k})" if k > 1 else name
        if np.array_equal(columns.setdefault(numbered, column), column, equal_nan=True):
            return


def _is_of_witness(frame: FrameType) -> bool:
    """Tell whether a frame runs a function of the witness: no library's, no comprehension, not what calls it."""
    module, function = str(frame.f_globals.get("__name__")), frame.f_code.co_name
    return module.split(".")[0] not in LIBRARIES and module != agree.__name__ and not function.startswith(("<", "__"))


def _items(held: Any) -> Mapping[str, Any]:
    """Return what a mapping, a dataclass or a short sequence holds, by name or number."""
    if isinstance(held, Mapping):
        return {key: item for key, item in held.items() if isinstance(key, str)}
    if is_dataclass(held) and not isinstance(held, type):
        return {f.name: getattr(held, f.name) for f in fields(held)}
    is_short = isinstance(held, tuple | list) and len(held) <= VALUES
    names = getattr(held, "_fields", None) or [str(n) for n in range(1, VALUES + 1)]
    return dict(zip(names, held, strict=False)) if is_short else {}


def _columns(name: str, held: Any, n: int, depth: int) -> Iterator[tuple[str, NDArray[np.float64]]]:
    """Yield the columns (n,) in a variable: an array, a row of one, or an item of a container."""
    if isinstance(held, np.ndarray) and held.dtype.kind in "fiub":
        if held.shape == (n,):
            yield name, held.astype(np.float64)
        elif held.ndim in (2, 3) and n in (held.shape[0], held.shape[-1]) and held.size <= n * SAMPLES:
            rows = held if held.shape[-1] == n else np.moveaxis(held, 0, -1)
            for k in np.ndindex(rows.shape[:-1]):
                yield f"{name}[{', '.join(map(str, k))}]", rows[k].astype(np.float64)
    elif depth:
        is_mapping = isinstance(held, Mapping)
        for key, item in _items(held).items():
            yield from _columns(f"{name}[{key!r}]" if is_mapping else f"{name}.{key}", item, n, depth - 1)


def _pairs(values: NDArray[np.float64], variables: Mapping[str, NDArray[np.float64]]) -> tuple[list[str], list[str]]:
    """Return for each signal the variable that equals it, and the one that mostly does but not in the first step."""
    names, stacked = list(variables), np.array(list(variables.values()))
    equal, meant = [""] * len(values), [""] * len(values)
    for i, row in enumerate(values if names else ()):
        same = _same(row, stacked)
        share = same.mean(axis=1)
        if (best := int(np.argmax(share))) >= 0 and share[best] == 1:
            equal[i] = names[best]
        elif (close := np.flatnonzero((share >= MOSTLY) & ~same[:, 0])).size and np.ptp(row) > 0:
            meant[i] = names[close[np.argmax(share[close])]]
    return equal, meant


def _same(row: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return where columns equal a signal (SAMPLES,) up to rounding."""
    size = np.max(np.abs(row[np.isfinite(row)]), initial=0.0)
    return np.isclose(others, row, rtol=0.0, atol=EQUAL * size, equal_nan=True)


def _path(
    block: Block, signals: _Signals, ends: Sequence[ca.SX], equal: Sequence[str], step: tuple[Columns, Columns]
) -> tuple[list[int], list[str]]:
    """Return the signals from those that agree to the expressions `ends`, in order, and the states and inputs read.

    The walk against the data flow ends at a signal that agrees, and leaves out branches that the first step does not
    take.
    """
    index = {e.element_hash(): i for i, e in enumerate(signals.exprs)}
    names = [*(s.name for s in block.inputs), *(s.name for s in block.states)]
    reads = {block.symbol[n].element_hash(): n for n in names}
    visited, path, agreed = set[int](), set[int](), list[str]()
    waiting, skipped = list(ends), _branches_not_taken(block, ends, step)
    while waiting:
        node = waiting.pop()
        key = node.element_hash()
        if key in visited:
            continue
        visited.add(key)
        if key in reads:
            agreed.append(reads[key])
        if key in index:
            path.add(index[key])
            if equal[index[key]]:
                continue
        waiting += [node.dep(k) for k in range(node.n_dep())] if key not in skipped else [node.dep(0)]
    return sorted(path), agreed


def _branches_not_taken(block: Block, exprs: Sequence[ca.SX], step: tuple[Columns, Columns]) -> set[int]:
    """Return the nodes `condition ? expression : 0` whose condition is false in the first of some steps."""
    choices, visited, waiting = list[ca.SX](), set[int](), list(exprs)
    while waiting:
        node = waiting.pop()
        if node.element_hash() not in visited:
            visited.add(node.element_hash())
            choices += [node] if node.op() == ca.OP_IF_ELSE_ZERO else []
            waiting += [node.dep(k) for k in range(node.n_dep())]
    values = _evaluate(block, [node.dep(0) for node in choices], *step)
    return {node.element_hash() for node, value in zip(choices, values, strict=True) if not value[0]}


def _place(
    block: Block, signals: _Signals, end: ca.SX, name: str, equal: Sequence[str], step: tuple[Columns, Columns]
) -> str:
    """Return the sentence that names the first signal of a result without an equal variable, and what it reads."""
    path, reads = _path(block, signals, [end], equal, step)
    others = [i for i in path if not equal[i]]
    first = next((i for i in others if signals.blocks[i]), next(iter(others), None))
    if first is None:
        agreed = _abbreviation([*(signals.labels[i] for i in path), *reads])
        return f"every signal on the way to '{name}' has an equal variable of the reference: it reads {agreed}"
    before, reads = _path(block, signals, [signals.exprs[first]], equal, step)
    agreed = _abbreviation([*(signals.labels[i] for i in before if equal[i]), *reads])
    between = [signals.labels[i] for i in before if i != first and not equal[i]]
    of_block = f" of Block '{signals.blocks[first]}'" if signals.blocks[first] else ""
    nor = f", nor {_abbreviation(between)} before it" if between else ""
    return f"no variable of the reference equals '{signals.labels[first]}'{of_block}{nor}; it reads {agreed}"


def _abbreviation(names: Sequence[str]) -> str:
    return ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")


def _of_values(
    block: Block,
    names: Sequence[str],
    law: Columns,
    other: Columns,
    known: Columns,
    chosen: NDArray[np.bool_],
    witness: str,
) -> Iterator[str]:
    """Yield what the values of the results that differ have in common: another's value, a factor, a limit."""
    ranges = {s.name: s for s in block.outputs} | {f"next {s.name}": s.signal for s in block.states}
    for k in (k for k in names if k in ranges):
        a, b, s = law[k], other[k], ranges[k]
        shares = {n: _same(b, v)[chosen].mean() for n, v in known.items() if n != k and np.ptp(v) > 0}
        same = max(shares, key=lambda n: shares[n], default=k)
        if shares.get(same, 0.0) >= MOSTLY:
            yield f"'{k}' of the {witness} has the value of '{same}' in {shares[same]:.0%} of {chosen.sum()} steps"
            continue
        nonzero = np.abs(a) > EQUAL * np.max(np.abs(a))
        ratio = b[nonzero] / a[nonzero]
        if len(ratio) > 1 and np.isfinite(ratio).all() and np.ptp(ratio) <= EQUAL * abs(ratio[0]):
            yield f"'{k}' of the {witness} is {ratio[0]:.9g} times that of the law in each of {len(b)} steps"
        if not s.low <= b[0] <= s.high:
            yield f"'{k}' of the {witness} is {b[0]:.9g}, outside its range {s.low:.9g} .. {s.high:.9g} {s.unit}"


def _terms(name: str, gap: NDArray[np.float64], known: Columns, chosen: NDArray[np.bool_], witness: str) -> str:
    """Return of which one or two signals the difference of a result is a weighted sum in the chosen steps, or ""."""
    columns = (
        {n: v[chosen] for n, v in known.items() if np.ptp(v[chosen]) > 0}
        if len(gap) > NAMED and np.isfinite(gap).all()
        else {}
    )
    for count in (1, 2):
        for names in combinations(columns, count):
            M = np.array([columns[n] / np.max(np.abs(columns[n])) for n in names]).T
            weights, _, rank, _ = np.linalg.lstsq(M, gap, rcond=EQUAL)
            if rank == count and np.max(np.abs(M @ weights - gap)) <= 1e3 * EQUAL * np.max(np.abs(gap)):
                each = (f"{w / np.max(np.abs(columns[n])):+.6g} {n}" for n, w in zip(names, weights, strict=True))
                return f"'{name}' of the {witness} less that of the law is {' '.join(each)} in {len(gap)} steps"
    return ""


def _of_faults(block: Block, bits: Sequence[Fault], words: tuple[int, int], witness: str) -> Iterator[str]:
    """Yield the bits in which the fault words differ, by the name of their flag, and those of no flag."""
    for f in bits:
        by_law = words[0] >> f.bit & 1
        yield f"bit {f.bit} of the fault word, '{f.output}', is {by_law}, {1 - by_law} by the {witness}"
    if stray := [k for k in range(32) if words[1] >> k & 1 and k not in [f.bit for f in block.faults]]:
        yield f"bit {stray[0]} of the fault word of the {witness} is 1, and no flag of '{block.name}' has it"


def _slopes(
    block: Block, names: Sequence[str], pair: tuple[Witness, Witness], step: tuple[Columns, Columns]
) -> Iterator[Slope]:
    """Yield the slopes of results along real states and inputs in which two programs differ, at one step."""
    signals = {s.name: s.signal for s in block.states if not s.integer} | {s.name: s for s in block.inputs}
    start = {**step[0], **step[1]}
    columns = {n: np.repeat(np.asarray(v, dtype=np.float64), 2 * len(signals)) for n, v in start.items()}
    for i, (n, s) in enumerate(signals.items()):
        size = STEP * (s.high - s.low)
        columns[n][2 * i : 2 * i + 2] = np.clip([columns[n][0] - size, columns[n][0] + size], s.low, s.high)
    x, u = ({n: columns[n] for n in part} for part in step)
    law, other = (_results(witness(x, u)) for witness in pair)
    ranges = {s.name: s for s in signals.values()}
    for k in names:
        moves = {n: columns[n][2 * i + 1] - columns[n][2 * i] for i, n in enumerate(signals)}
        with np.errstate(invalid="ignore", divide="ignore"):
            a, b = (
                {n: (r[k][2 * i + 1] - r[k][2 * i]) / moves[n] for i, n in enumerate(signals)} for r in (law, other)
            )
        reach = {n: max(abs(a[n]), abs(b[n])) * (ranges[n].high - ranges[n].low) for n in signals}
        least = LEAST_SLOPE * max(reach.values(), default=0.0)
        for n in signals:
            if reach[n] > least and abs(a[n] - b[n]) > SLOPE * max(abs(a[n]), abs(b[n])):
                yield Slope(k, n, float(a[n]), float(b[n]))
