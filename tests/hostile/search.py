"""Fuzzing of the library's interface: each public function is called with one wrong argument.

    python -m tests.hostile.search [--calls 10000] [--seed 0] [--only lqr]

For each function and constructor of the vocabulary, of analyse, of synthesise and of blocks there is a valid call
(`calls`). Each argument in turn is then replaced: by another type (a number for a list, a text, None, a bool),
by another shape or size, by NaN, infinity, 1e300 and 1e-300, by an empty value, by a masked array, by a wrong name, and
by the same value in another form, for which the answer must be the same. A call must return or raise a SynthError
within `LIMIT_S`. Everything else is a defect: another error, NaN in an answer whose example has none, a warning of
NumPy with an answer, another answer to the same value, or a longer time.

Internal functions, which take checked values like NumPy arrays or Arb balls, are left out: `synth.arguments.checked`
marks the others.
"""

import argparse
import contextlib
import dataclasses
import faulthandler
import functools
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

import numpy as np

import synth.analyse
import synth.blocks
import synth.synthesise
from synth.errors import SynthError
from tests.hostile import calls, examples
from tests.hostile.values import SAME, mutations

LIMIT_S = 5.0  # of processor time, which does not depend on other load
MEMORY = 4 << 30  # bytes
VOCABULARY = ("signals", "timing", "plant", "statespace", "fault", "block", "composition")
UNCHECKED = ("timing.Discrete", "logs.Log")  # check their own arguments
NAN_MEANS = {
    "structure.poles": "the damping of a pole at 0",
    "structure.transmission_zeros": "the damping of a zero at 0",
    "least_squares.solve": "R^2 of an output that does not vary",
    "gauss_newton.minimise": "R^2 of an output that does not vary",
}


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
    """The outcome of a call: "answer", "refused" or a defect, with its error or warning, and the seconds it took."""

    kind: str
    text: str
    seconds: float

    @property
    def is_defect(self) -> bool:
        """Whether the outcome is a defect of the library."""
        return self.kind not in ("answer", "refused")


def modules() -> list[ModuleType]:
    """Return the modules of the vocabulary, of analyse, of synthesise and of blocks."""
    layers = (synth.analyse, synth.synthesise, synth.blocks)
    names = [f"synth.{name}" for name in VOCABULARY]
    names += [m.name for layer in layers for m in pkgutil.walk_packages(layer.__path__, f"{layer.__name__}.")]
    return [importlib.import_module(name) for name in names]


def is_checked(target: Any) -> bool:
    """Return whether a function or constructor is decorated with `arguments.checked`."""
    code = getattr(target.__init__ if inspect.isclass(target) else target, "__code__", None)
    return code is not None and code.co_filename.endswith("arguments.py")


@functools.cache
def library() -> dict[str, Callable[..., Any]]:
    """Return the public functions and constructors with checked arguments, by module and name."""
    functions = {}
    for module in modules():
        short = module.__name__.rpartition(".")[2]
        for name, target in vars(module).items():
            is_public = getattr(target, "__module__", None) == module.__name__ and not name.startswith("_")
            if is_public and callable(target) and (is_checked(target) or f"{short}.{name}" in UNCHECKED):
                functions[f"{short}.{name}"] = target
    return functions


def call(function: Callable[..., Any], arguments: Mapping[str, Any]) -> Any:
    """Call a function with arguments by name, and those of its ``*args`` by position."""
    keywords = dict(arguments)
    further = [p.name for p in inspect.signature(function).parameters.values() if p.kind is p.VAR_POSITIONAL]
    for name in further:
        values = keywords.pop(name)
        return function(*(values if isinstance(values, list | tuple) else [values]), **keywords)
    return function(**keywords)


def example(name: str, function: Callable[..., Any]) -> dict[str, Any]:
    """Return valid arguments of a function: specific ones, else those by argument name, else its defaults."""
    specific, usual = calls.examples().get(name, {}), examples.usual()
    arguments: dict[str, Any] = {}
    for p in inspect.signature(function).parameters.values():
        if p.name in specific:
            arguments[p.name] = specific[p.name]
        elif p.default is p.empty and p.kind is not p.VAR_KEYWORD:
            arguments[p.name] = usual[p.name]
    return arguments


def cases(only: str = "") -> list[Case]:
    """Return all cases, in the order of the library, of the functions whose name contains `only`."""
    all_cases = []
    for name, function in library().items():
        if only not in name:
            continue
        good = example(name, function)
        for p in inspect.signature(function).parameters.values():
            value = good.get(p.name, p.default)
            all_cases += [Case(name, function, {**good, p.name: bad}, p.name, how) for how, bad in mutations(value)]
    return all_cases


class TooSlow(BaseException):
    """A call exceeded the time limit; a BaseException, which no handler of the library catches."""


@contextlib.contextmanager
def _time_limit(seconds: float) -> Iterator[None]:
    def stop(number: int, frame: FrameType | None) -> None:
        raise TooSlow

    before = signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def evaluate(case: Case, good: Any, limit_s: float = LIMIT_S) -> Outcome:
    """Run a case and return its outcome; `good` is the answer of the example."""
    start = time.process_time()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            with _time_limit(limit_s):
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
    seconds = time.process_time() - start
    if kind == "answer":
        kind, text = _classify_answer(case, good, answer, [str(w.message) for w in caught])
    return Outcome(kind, text.partition("\n")[0], seconds)


def _classify_answer(case: Case, good: Any, answer: Any, caught: list[str]) -> tuple[str, str]:
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
    if isinstance(answer, int | float | complex | np.number) and not isinstance(answer, bool):
        return np.array([complex(answer)])
    if isinstance(answer, np.ndarray) and answer.dtype.kind in "fciu":
        return answer.ravel().astype(complex)
    if depth and dataclasses.is_dataclass(answer):
        answer = [getattr(answer, f.name) for f in dataclasses.fields(answer)]
    if isinstance(answer, Mapping):
        answer = list(answer.values())
    if depth and isinstance(answer, list | tuple):
        return np.concatenate([np.zeros(0), *(_numbers(part, depth - 1) for part in answer)])
    return np.zeros(0)


def search(
    calls: int, seed: int, only: str = "", progress: bool = False, limit_s: float = LIMIT_S
) -> list[tuple[Case, Outcome]]:
    """Return `calls` cases, or all if there are fewer, drawn by `seed` without replacement, with their outcomes."""
    every = cases(only)
    sample = [every[k] for k in np.random.default_rng(seed).permutation(len(every))[:calls]]
    return evaluate_each(sample, progress, limit_s)


def evaluate_each(some: Sequence[Case], progress: bool = False, limit_s: float = LIMIT_S) -> list[tuple[Case, Outcome]]:
    """Return cases with their outcomes."""
    functions = {case.name: case.function for case in some}
    good = {name: call(function, example(name, function)) for name, function in functions.items()}
    outcomes = []
    for k, case in enumerate(some):
        outcomes.append((case, evaluate(case, good[case.name], limit_s)))
        if progress and k % 500 == 499:
            print(f"{k + 1} calls", file=sys.stderr)  # noqa: T201
    return outcomes


def report(outcomes: Sequence[tuple[Case, Outcome]]) -> str:
    """Return the tally, and each distinct defect with its count and one of its calls."""
    tally = Counter(outcome.kind for _, outcome in outcomes)
    case, slowest = max(outcomes, key=lambda pair: pair[1].seconds)
    lines = [f"{len(outcomes)} calls of {len({c.name for c, _ in outcomes})} functions: "]
    lines[0] += ", ".join(f"{count} {kind}" for kind, count in tally.most_common())
    lines.append(f"slowest: {slowest.seconds:.2f} s, {case.name}({case.argument} = {case.mutation})")
    defects: dict[tuple[str, ...], list[Case]] = {}
    for case, outcome in outcomes:
        if outcome.is_defect:
            defects.setdefault((case.name, case.argument, outcome.kind, outcome.text[:100]), []).append(case)
    for (name, argument, kind, text), failing in sorted(defects.items()):
        lines.append(f"{name}({argument} = {failing[0].mutation}) {len(failing)} x {kind}: {text}")
    return "\n".join(lines)


def main() -> None:
    """Search, print the report, and exit with 1 where there are defects."""
    parser = argparse.ArgumentParser(description="Call every public function with one wrong argument.")
    parser.add_argument("--calls", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", default="", help="functions whose name contains this")
    options = parser.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))  # a call that needs more gets a MemoryError, a raw error
    faulthandler.dump_traceback_later(4 * LIMIT_S, repeat=True)  # shows a call that no alarm interrupts
    outcomes = search(options.calls, options.seed, options.only, progress=True)
    print(report(outcomes))  # noqa: T201
    sys.exit(any(outcome.is_defect for _, outcome in outcomes))


if __name__ == "__main__":
    main()
