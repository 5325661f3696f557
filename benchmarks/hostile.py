"""Hostile calls: each public function of the library, called with one argument that is wrong.

    python -m benchmarks.hostile [--calls 10000] [--seed 0] [--only lqr]

For each function and constructor of the vocabulary, of analyse and of synthesise there is a call that works
(`hostile_examples`). Each argument in turn is then replaced: by another kind of thing (a number for a list, a text,
None, a bool), by another shape or size, by NaN, infinity, 1e300 and 1e-300, by nothing, by a masked array, by a wrong
name, and by the same value in another form, for which the answer must be the same. A call must answer or raise a
SynthError, within `LIMIT_S`. Everything else is a defect: another error, NaN in an answer whose example has none, a
warning of NumPy beside an answer, another answer to the same value, or a longer time.

Functions that take what others have read already (`INNER`, and those with NumPy arrays or Arb balls for arguments) are
left out; that is what `synth.arguments.checked` marks.
"""

import argparse
import contextlib
import dataclasses
import faulthandler
import importlib
import inspect
import pkgutil
import resource
import signal
import sys
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import FrameType, ModuleType
from typing import Any

import casadi as ca
import numpy as np

import synth.analyse
import synth.synthesise
from benchmarks import hostile_examples
from synth.errors import SynthError
from synth.statespace import StateSpace

LIMIT_S = 5.0
MEMORY = 4 << 30  # bytes
VOCABULARY = ("signals", "timing", "plant", "statespace", "block", "compose", "check")
UNCHECKED = ("timing.Discrete", "check.Check", "safety.Guarded", "logs.Log")  # constructors that read for themselves
NAN_MEANS = {
    "structure.poles": "the damping of a pole at 0",
    "structure.transmission_zeros": "the damping of a zero at 0",
    "least_squares.solve": "R^2 of an output that does not vary",
    "gauss_newton.minimise": "R^2 of an output that does not vary",
}
SAME = "the same as "  # a mutation of that name changes the form of a value, not the value


@dataclasses.dataclass(frozen=True, eq=False)
class Case:
    """A function with arguments of which `argument` has been replaced, as `mutation` says."""

    name: str
    function: Callable[..., Any]
    arguments: Mapping[str, Any]
    argument: str
    mutation: str


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What became of a call: "answer", "refused" or a defect, with its error or warning, and the seconds it took."""

    kind: str
    text: str
    seconds: float

    @property
    def is_defect(self) -> bool:
        """Whether the library should have done otherwise."""
        return self.kind not in ("answer", "refused")


def modules() -> list[ModuleType]:
    """Return the modules of the vocabulary, of analyse and of synthesise."""
    layers = (synth.analyse, synth.synthesise)
    names = [f"synth.{name}" for name in VOCABULARY]
    names += [m.name for layer in layers for m in pkgutil.iter_modules(layer.__path__, f"{layer.__name__}.")]
    return [importlib.import_module(name) for name in names]


def is_checked(target: Any) -> bool:
    """Tell whether `arguments.checked` stands at a function or constructor."""
    code = getattr(target.__init__ if inspect.isclass(target) else target, "__code__", None)
    return code is not None and code.co_filename.endswith("arguments.py")


def library() -> dict[str, Callable[..., Any]]:
    """Return the public functions and constructors that take what a user gives, by module and name."""
    found = {}
    for module in modules():
        short = module.__name__.rpartition(".")[2]
        for name, target in vars(module).items():
            own = getattr(target, "__module__", None) == module.__name__ and not name.startswith("_")
            if own and callable(target) and (is_checked(target) or f"{short}.{name}" in UNCHECKED):
                found[f"{short}.{name}"] = target
    return found


def call(function: Callable[..., Any], arguments: Mapping[str, Any]) -> Any:
    """Call a function with arguments by name, and those of its ``*args`` by place."""
    given = dict(arguments)
    further = [p.name for p in inspect.signature(function).parameters.values() if p.kind is p.VAR_POSITIONAL]
    for name in further:
        values = given.pop(name)
        return function(*(values if isinstance(values, list | tuple) else [values]), **given)
    return function(**given)


def example(name: str, function: Callable[..., Any]) -> dict[str, Any]:
    """Return arguments with which a function works: its own, else those of their names, else its defaults."""
    own, usual = hostile_examples.own().get(name, {}), hostile_examples.usual()
    given: dict[str, Any] = {}
    for p in inspect.signature(function).parameters.values():
        if p.name in own:
            given[p.name] = own[p.name]
        elif p.default is p.empty and p.kind is not p.VAR_KEYWORD:
            given[p.name] = usual[p.name]
    return given


ANYTHING: dict[str, Any] = {
    "None": None,
    "a text": "text",
    "an empty text": "",
    "a bool": True,
    "a complex number": 1 + 2j,
    "bytes": b"x",
    "0": 0,
    "-1": -1,
    "1.5": 1.5,
    "NaN": np.nan,
    "infinity": np.inf,
    "-infinity": -np.inf,
    "1e300": 1e300,
    "-1e300": -1e300,
    "1e-300": 1e-300,
    "a large whole number": 10**30,
    "2**40": 2**40,
    "float32": np.float32(0.1),
    "an empty list": [],
    "a list of a number": [1.0],
    "a list of texts": ["a", "b"],
    "a list of None": [None],
    "nested lists": [[1.0, 2.0], [3.0]],
    "an empty mapping": {},
    "a mapping": {"x": 1.0},
    "a set": {1.0},
    "an empty array": np.zeros((0, 0)),
    "a row": np.ones((1, 3)),
    "three dimensions": np.ones((1, 1, 1)),
    "a NaN array": np.full((2, 2), np.nan),
    "a large array": np.full((2, 2), 1e300),
    "an object": object(),
    "a complex array": np.full((2, 2), 1j),
    "an array of texts": np.array([["a"]]),
    "a function": lambda *a: None,
    "a masked array": np.ma.array(np.ones((2, 2)), mask=np.eye(2)),
    "masked": np.ma.masked,
    "a symbol": ca.SX.sym("s"),
    "an array of objects": np.array([None, 1.0], dtype=object),
}


def mutations(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield replacements of a good value, each with its name."""
    yield from ANYTHING.items()
    if isinstance(value, np.ndarray) or _is_table(value):
        yield from _arrays(np.asarray(value))
    if isinstance(value, np.ndarray):
        yield SAME + "lists", value.tolist()
        yield SAME + "Fortran's order", np.asfortranarray(value)
        yield SAME + "a mask of nothing", np.ma.array(value)
    if isinstance(value, float | int) and not isinstance(value, bool):
        yield from {"negative": -value, "a hundred times": 100 * value, "a list of it": [value]}.items()
        yield SAME + "a NumPy scalar", np.float64(value) if isinstance(value, float) else np.int64(value)
    if isinstance(value, list | tuple):
        yield from _lists(value)
    if isinstance(value, Mapping):
        yield from _mappings(value)
    if isinstance(value, StateSpace):
        yield from _models(value)


def _is_table(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(row, list | float) for row in value)


def _arrays(value: Any) -> Iterator[tuple[str, Any]]:
    array = value.astype(float) if value.dtype.kind in "if" else value
    yield from {"transposed": array.T, "flat": array.ravel(), "one more dimension": array[None]}.items()
    yield from {"one row less": array[:-1], "doubled": np.concatenate([array, array]), "negative": -array}.items()
    yield from {
        "zero": 0 * array,
        "single precision": array.astype(np.complex64 if array.dtype.kind == "c" else np.float32),
    }.items()
    yield from {"huge": 1e300 * array, "tiny": 1e-300 * array, "large": 1e90 * array, "small": 1e-90 * array}.items()
    for name, number in (("NaN", np.nan), ("infinity", np.inf), ("1e300", 1e300), ("1e200", 1e200), ("1j", 1j)):
        changed = array.astype(complex) if name == "1j" else array.copy()
        if changed.size:
            changed.flat[0] = number
        yield f"{name} first", changed
    mask = np.zeros(array.shape, dtype=bool)
    mask.flat[:1] = True
    yield "the first masked", np.ma.array(array, mask=mask)
    yield "text", array.astype(str)


def _lists(value: Sequence[Any]) -> Iterator[tuple[str, Any]]:
    items = list(value)
    for name, entry in (("None", None), ("a text", "text"), ("NaN", np.nan), ("1e300", 1e300), ("a bool", True)):
        yield f"{name} added", [*items, entry]
        yield f"{name} first", [entry, *items[1:]]
    yield from {"its first entry": items[0] if items else 0.0, "doubled": items * 2, "nested": [items]}.items()
    yield from {"without the last": items[:-1], "as keys": {str(k): v for k, v in enumerate(items)}}.items()
    yield SAME + "a tuple", tuple(items)


def _mappings(value: Mapping[Any, Any]) -> Iterator[tuple[str, Any]]:
    yield "a wrong name", {**value, "wrong": next(iter(value.values()), 1.0)}
    yield "a number for a name", {**value, 3: 1.0}
    yield "its names", list(value)
    yield "its values", list(value.values())
    for name, entry in (("None", None), ("text", "text"), ("NaN", np.nan), ("infinity", np.inf), ("1e300", 1e300)):
        yield f"{name} inside", dict.fromkeys(value, entry)
    yield "a list inside", {key: [1.0] for key in value}


def _models(value: StateSpace) -> Iterator[tuple[str, Any]]:
    A, B, C, D = value.A, value.B, value.C, value.D
    n, m, p = len(A), B.shape[1], len(C)
    yield "arrays with NaN", (A * np.nan, B, C, D, value.time)
    yield "arrays with 1e300", (A, 1e300 * B, C, D, value.time)
    for size in (1e-300, 1e-90, 1e90):
        yield f"A {size:g}", dataclasses.replace(value, A=A * size)
        yield f"B {size:g}", dataclasses.replace(value, B=B * size)
        yield f"C {size:g}", dataclasses.replace(value, C=C * size)
    yield "a masked A", (np.ma.array(A, mask=np.eye(n)), B, C, D, value.time)
    yield "a complex A", (A * 1j, B, C, D, value.time)
    yield "A of zeros", dataclasses.replace(value, A=0 * A)
    yield "B of zeros", dataclasses.replace(value, B=0 * B)
    yield "C of zeros", dataclasses.replace(value, C=0 * C)
    yield "A as text", ("text", B, C, D)
    yield "shapes that do not fit", (A, B[:-1], C, D)
    yield "A alone", (A,)
    yield "no states", dataclasses.replace(value, A=np.zeros((0, 0)), B=np.zeros((0, m)), C=np.zeros((p, 0)), states=())
    yield "no inputs", dataclasses.replace(value, B=np.zeros((n, 0)), D=np.zeros((p, 0)), inputs=())
    yield "no outputs", dataclasses.replace(value, C=np.zeros((0, n)), D=np.zeros((0, m)), outputs=())
    yield "python-control, dt None", _control(value, None)
    yield "python-control, dt True", _control(value, True)
    yield "a static gain of python-control", _gain()
    yield "unstable", dataclasses.replace(value, A=-A)


def _control(model: StateSpace, dt: Any) -> Any:
    import control

    return control.StateSpace(model.A, model.B, model.C, model.D, dt)


def _gain() -> Any:
    import control

    return control.ss([], [], [], [[2.0]])


def cases(only: str = "") -> list[Case]:
    """Return all cases, in the order of the library, of the functions whose name contains `only`."""
    found = []
    for name, function in library().items():
        if only not in name:
            continue
        good = example(name, function)
        for p in inspect.signature(function).parameters.values():
            value = good.get(p.name, p.default)
            found += [Case(name, function, {**good, p.name: bad}, p.name, how) for how, bad in mutations(value)]
    return found


class TooSlow(BaseException):
    """A call ran into the limit; no handler of the library for errors stops it."""


@contextlib.contextmanager
def _limited(seconds: float) -> Iterator[None]:
    def stop(number: int, frame: FrameType | None) -> None:
        raise TooSlow

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def judge(case: Case, good: Any, limit_s: float = LIMIT_S) -> Outcome:
    """Call, and say what became of it; `good` is the answer of the example."""
    start = time.perf_counter()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            with _limited(limit_s):
                answer = call(case.function, case.arguments)
                if not inspect.isclass(case.function):
                    repr(answer)
            kind, text = "answer", ""
        except SynthError as error:
            kind, text = "refused", str(error)
        except TooSlow:
            kind, text = "too slow", f"over {limit_s:g} s"
        except (Exception, SystemExit) as error:
            kind, text = "raw error", f"{type(error).__name__}: {error}"
    seconds = time.perf_counter() - start
    if kind == "answer":
        kind, text = _judge_answer(case, good, answer, [str(w.message) for w in caught])
    return Outcome(kind, text.partition("\n")[0], seconds)


def _judge_answer(case: Case, good: Any, answer: Any, caught: list[str]) -> tuple[str, str]:
    was, now = _numbers(good), _numbers(answer)
    if (
        case.name not in NAN_MEANS
        and np.isnan(now).any()
        and not np.isnan(was).any()
        and not inspect.isclass(case.function)
    ):
        return "NaN", "an answer with NaN"
    if caught:
        return "warning", caught[0]
    if case.mutation.startswith(SAME) and not (was.shape == now.shape and np.allclose(was, now, 1e-6, 1e-9, True)):
        return "wrong", "another answer to the same value"
    return "answer", ""


def _numbers(answer: Any, depth: int = 4) -> Any:
    """Return the numbers in an answer, as far as `depth` levels down."""
    if isinstance(answer, float | complex | int | np.number):
        return np.array([complex(answer)]) if abs(answer) < 1e308 or isinstance(answer, float) else np.zeros(0)
    if isinstance(answer, np.ndarray) and answer.dtype.kind in "fciu":
        return answer.ravel().astype(complex)
    if depth and dataclasses.is_dataclass(answer):
        answer = [getattr(answer, f.name) for f in dataclasses.fields(answer)]
    if isinstance(answer, Mapping):
        answer = list(answer.values())
    if depth and isinstance(answer, list | tuple):
        return np.concatenate([np.zeros(0), *(_numbers(part, depth - 1) for part in answer)])
    return np.zeros(0)


def search(calls: int, seed: int, only: str = "", progress: bool = False) -> list[tuple[Case, Outcome]]:
    """Return `calls` cases, or all if there are fewer, drawn by `seed` without replacement, with their outcomes."""
    every = cases(only)
    drawn = [every[k] for k in np.random.default_rng(seed).permutation(len(every))[:calls]]
    good = {name: call(function, example(name, function)) for name, function in library().items() if only in name}
    outcomes = []
    for k, case in enumerate(drawn):
        outcomes.append((case, judge(case, good[case.name])))
        if progress and k % 500 == 499:
            print(f"{k + 1} calls", file=sys.stderr)  # noqa: T201
    return outcomes


def report(outcomes: Sequence[tuple[Case, Outcome]]) -> str:
    """Return the tally, and each distinct defect with its count and one of its calls."""
    tally = Counter(outcome.kind for _, outcome in outcomes)
    slowest, case = max(((outcome.seconds, case) for case, outcome in outcomes), key=lambda pair: pair[0])
    lines = [f"{len(outcomes)} calls of {len({c.name for c, _ in outcomes})} functions: "]
    lines[0] += ", ".join(f"{count} {kind}" for kind, count in tally.most_common())
    lines.append(f"slowest: {slowest:.2f} s, {case.name}({case.argument} = {case.mutation})")
    defects: dict[tuple[str, ...], list[Case]] = {}
    for case, outcome in outcomes:
        if outcome.is_defect:
            defects.setdefault((case.name, case.argument, outcome.kind, outcome.text[:100]), []).append(case)
    for (name, argument, kind, text), found in sorted(defects.items()):
        lines.append(f"{name}({argument} = {found[0].mutation}) {len(found)} x {kind}: {text}")
    return "\n".join(lines)


def main() -> None:
    """Search, print the report, and exit with 1 where there are defects."""
    parser = argparse.ArgumentParser(description="Call every public function with one wrong argument.")
    parser.add_argument("--calls", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="functions whose name contains this")
    given = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))  # what asks for more gets a MemoryError, a raw error
    faulthandler.dump_traceback_later(4 * LIMIT_S, repeat=True)  # names what no alarm interrupts
    outcomes = search(given.calls, given.seed, given.only, progress=True)
    print(report(outcomes))  # noqa: T201
    sys.exit(any(outcome.is_defect for _, outcome in outcomes))


if __name__ == "__main__":
    main()
