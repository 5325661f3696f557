"""Mutation testing (as `mutmut`, `cosmic-ray`): random changes of operators in modules, each run against its tests.

    python -m benchmarks.mutation [MODULE...] [--mutants 30] [--seed 0] [--json FILE] [--compare FILE]

A mutant is killed where a test fails, or takes several times the processor time of the unchanged module. Its tests are
tests/<path>/test_<name>.py and, of the files of that folder and of those ACROSS folders that import the module, the
tests that are not `slow`. None is marked `whole`: the run judges what `make test` notices.
Seed and text of a module determine its mutants. --compare exits with 1 where a module kills fewer than in a --json
file of an earlier run. Run it in the root of a repository.

A process imports the libraries once; each mutant is a fork of it that compiles the changed syntax tree in place of the
file. What tests start as another command runs the unchanged module. Each mutant has a cache of results of its own.
"""

import argparse
import ast
import importlib
import json
import os
import random
import resource
import shutil
import signal
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import partial
from hashlib import sha256
from importlib.machinery import SourceFileLoader
from math import ceil
from pathlib import Path
from time import monotonic
from typing import Any, NoReturn

MODULES = (
    "synth/signals.py",
    "synth/composition.py",
    "synth/analyse/structure/relative_degree.py",
    "synth/analyse/loops/transfer.py",
    "synth/synthesise/feedback/lqr.py",
    "synth/blocks/guard/safety.py",
    "synth/emit/passes/fold.py",
    "synth/execute/elf.py",
    "synth/simulate/metrics.py",
    "synth/verify/agree.py",
    "synth/report/audit.py",
)
ACROSS = (  # below tests: tables and properties of many modules
    *(("refusals", f"test_{folder}.py") for folder in ("analyse", "synthesise", "regulation", "blocks")),
    ("blocks", "test_every_block.py"),
)
LIBRARIES = (
    *("numpy", "scipy.linalg", "scipy.optimize", "scipy.signal", "scipy.stats", "casadi", "sympy", "control"),
    *("matplotlib.figure", "jinja2", "rich.console", "typer", "pytest", "hypothesis.extra.numpy"),
)
OPERATORS: Mapping[type[ast.AST], tuple[type[ast.AST], ...]] = {
    ast.Lt: (ast.LtE, ast.GtE), ast.LtE: (ast.Lt, ast.Gt), ast.Gt: (ast.GtE, ast.LtE), ast.GtE: (ast.Gt, ast.Lt),
    ast.Eq: (ast.NotEq,), ast.NotEq: (ast.Eq,), ast.Is: (ast.IsNot,), ast.IsNot: (ast.Is,),
    ast.In: (ast.NotIn,), ast.NotIn: (ast.In,), ast.And: (ast.Or,), ast.Or: (ast.And,),
    ast.Add: (ast.Sub,), ast.Sub: (ast.Add,), ast.Mult: (ast.Div,), ast.Div: (ast.Mult,), ast.Pow: (ast.Mult,),
    ast.FloorDiv: (ast.Mult,), ast.Mod: (ast.FloorDiv,), ast.BitAnd: (ast.BitOr,), ast.BitOr: (ast.BitAnd,),
}  # fmt: skip
NUMBERS = ("float", "int", "Array", "SX", "Complex")  # in the annotation of a function whose result is negated
MORE_TIME, MORE_S = 4.0, 10.0  # a mutant may take so many times the processor time of no mutant, and so many s more
MEMORY = 8 * 2**30  # bytes of a process
KILLED, SURVIVED, NOT_IMPORTED = 1, 0, 99  # exit status of a child


@dataclass(frozen=True)
class Mutant:
    """A change of a line; `killed` tells whether a test noticed."""

    line: int
    change: str
    killed: bool


@dataclass(frozen=True)
class Result:
    """The mutants of a module, whose text has the SHA-256 `text`, under some tests."""

    module: str
    text: str
    tests: tuple[str, ...]
    mutants: tuple[Mutant, ...]

    @property
    def kills(self) -> int:
        """Number of mutants that a test noticed."""
        return sum(mutant.killed for mutant in self.mutants)


def changes(node: ast.AST, returns: str = "") -> Iterator[tuple[Any, Callable[[], None]]]:
    """Yield each node that can change, and the function that changes it; messages of errors and types stay.

    `returns` is the annotation of the function around the node.
    """
    children: list[Any] = [*ast.iter_child_nodes(node)]
    if isinstance(node, ast.FunctionDef):
        returns, children = ast.unparse(node.returns) if node.returns else "", [node.args, *node.body]
    elif isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
        children = node.orelse
    elif isinstance(node, ast.AnnAssign):
        children = [node.value] if node.value else []
    elif isinstance(node, ast.Raise | ast.JoinedStr | ast.arg):
        return
    if isinstance(node, ast.Compare):
        for k, operator in enumerate(node.ops):
            yield from ((node, partial(node.ops.__setitem__, k, new())) for new in OPERATORS[type(operator)])
    elif isinstance(node, ast.BinOp | ast.BoolOp | ast.AugAssign):
        yield from ((node, partial(setattr, node, "op", new())) for new in OPERATORS.get(type(node.op), ()))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
        yield node, partial(setattr, node, "operand", ast.UnaryOp(ast.Not(), node.operand))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        yield node, partial(setattr, node, "op", ast.UAdd())
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool):
        yield node, partial(setattr, node, "value", not node.value)
    elif isinstance(node, ast.Constant) and isinstance(node.value, int | float):
        yield node, partial(setattr, node, "value", node.value + 1)
    elif isinstance(node, ast.Return) and isinstance(node.value, ast.Compare | ast.BoolOp):
        yield node, partial(setattr, node, "value", ast.UnaryOp(ast.Not(), node.value))
    elif isinstance(node, ast.Return) and node.value and any(number in returns for number in NUMBERS):
        yield node, partial(setattr, node, "value", ast.UnaryOp(ast.USub(), node.value))
    for child in children:
        yield from changes(child, returns)


def mutate(text: str, number: int) -> tuple[ast.Module, int, str]:
    """Return the tree of a module with one of its changes, the line, and the text before and after."""
    tree = ast.parse(text)
    node, change = [*changes(tree)][number]
    before = ast.unparse(node)
    change()
    return ast.fix_missing_locations(tree), node.lineno, f"{before}  ->  {ast.unparse(node)}"


def tests_of(module: Path) -> tuple[Path, ...]:
    """Return the test file of a module, and the others of its folder and ACROSS folders that import the module."""
    folder, name = Path("tests", *module.parts[1:-1]), ".".join(module.with_suffix("").parts)
    first = folder / f"test_{module.stem}.py"
    others = [*sorted(folder.glob("test_*.py")), *(Path("tests", *parts) for parts in ACROSS)]
    neighbours = [path for path in others if path != first and path.exists() and name in _imports(path)]
    return (*([first] if first.exists() else []), *neighbours)


def _imports(path: Path) -> set[str]:
    names = set[str]()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            names |= {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    return names


class Quick:
    """A plugin of pytest that leaves out the tests of whole campaigns, and slow ones but of a module's own file."""

    def __init__(self, whole: str) -> None:
        self.whole = whole

    def pytest_collection_modifyitems(self, items: list[Any]) -> None:
        """Keep the tests of the module's own file and those that are not slow, none of them `whole`."""
        items[:] = [
            item
            for item in items
            if not item.get_closest_marker("whole")
            and (item.path.name == self.whole or not item.get_closest_marker("slow"))
        ]


def run_tests(
    module: Path, tree: ast.Module | None, cache: Path, limits: tuple[float, float]
) -> tuple[int, float, float]:
    """Run the tests of a module, with a tree in place of its file; return exit status, processor time and time in s.

    `limits` are those of the processor time and of the time; `cache` is the folder of the results.
    """
    start, child = monotonic(), os.fork()
    if child == 0:
        try:
            _run_in_child(module, tree, cache, limits)
        finally:
            os._exit(KILLED)
    _, status, used = os.wait4(child, 0)
    with suppress(ProcessLookupError):  # what a test has started and a limit has left
        os.killpg(child, signal.SIGKILL)
    return os.waitstatus_to_exitcode(status), used.ru_utime + used.ru_stime, monotonic() - start


def _run_in_child(module: Path, tree: ast.Module | None, cache: Path, limits: tuple[float, float]) -> NoReturn:
    import pytest

    os.setsid()
    resource.setrlimit(resource.RLIMIT_CPU, (ceil(limits[0]), ceil(limits[0])))
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    signal.alarm(ceil(limits[1]))
    os.environ["SYNTH_CACHE"] = str(cache)
    nothing = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(nothing, stream)
    sys.path.insert(0, str(Path.cwd()))
    loaded, get_code = list[str](), SourceFileLoader.get_code

    def changed_code(loader: SourceFileLoader, name: str) -> Any:
        if Path(loader.path) != module.absolute():
            return get_code(loader, name)
        loaded.append(name)
        return get_code(loader, name) if tree is None else compile(tree, loader.path, "exec")

    setattr(SourceFileLoader, "get_code", changed_code)  # noqa: B010
    tests = [str(path) for path in tests_of(module)]
    status = pytest.main(["-x", "-q", "-p", "no:cacheprovider", *tests], [Quick(f"test_{module.stem}.py")])
    os._exit(KILLED if status else SURVIVED if loaded else NOT_IMPORTED)


def measure(module: Path, most: int, seed: int) -> Result:
    """Return the result of `most` random mutants of a module, or of all if there are fewer; report each to stderr.

    Raises SystemExit for a module without tests, with tests that fail without a change, or that do not import it.
    """
    text, tests = module.read_text(encoding="utf-8"), tests_of(module)
    if not tests:
        raise SystemExit(f"{module}: no test file of its name, and none in that folder imports it: choose another")
    numbers = range(len([*changes(ast.parse(text))]))
    chosen = sorted(random.Random(f"{seed} {module}").sample(numbers, min(most, len(numbers))))
    mutants = []
    with tempfile.TemporaryDirectory(prefix="mutation-") as folder:
        unchanged = Path(folder, "unchanged")
        unchanged.mkdir()
        status, processor, duration = run_tests(module, None, unchanged, (1e4, 1e4))
        if status:
            why = "do not import it" if status == NOT_IMPORTED else "fail without a mutant"
            raise SystemExit(f"{module}: its tests {why}: run `pytest {' '.join(map(str, tests))}`")
        sys.stderr.write(f"{module}: {len(numbers)} possible changes, tests take {duration:.1f} s\n")
        shutil.rmtree(
            unchanged / "results", ignore_errors=True
        )  # they are known by the text of the file; compiled C is not
        limits = MORE_TIME * processor + MORE_S, 2 * MORE_TIME * duration + 10 * MORE_S
        for k, number in enumerate(chosen, 1):
            tree, line, change = mutate(text, number)
            shutil.copytree(unchanged, Path(folder, str(k)))
            status, _, duration = run_tests(module, tree, Path(folder, str(k)), limits)
            shutil.rmtree(Path(folder, str(k)))
            mutants.append(Mutant(line, change, status != SURVIVED))
            said = f"{'killed' if status else 'SURVIVED'} in {duration:.1f} s, line {line}: {change}"
            sys.stderr.write(f"{module} {k}/{len(chosen)}: {said}\n")
    return Result(str(module), sha256(text.encode()).hexdigest(), tuple(map(str, tests)), tuple(mutants))


def table(results: Sequence[Result]) -> Iterator[str]:
    """Yield the lines of the table: each module, and its survivors."""
    yield f"{'module':<45}{'mutants':>9}{'killed':>9}"
    for result in results:
        yield f"{result.module:<45}{len(result.mutants):>9}{result.kills:>9}"
        yield from (f"    survived, line {m.line}: {m.change}" for m in result.mutants if not m.killed)
    yield f"{'all':<45}{sum(len(r.mutants) for r in results):>9}{sum(r.kills for r in results):>9}"


def losses(results: Sequence[Result], earlier: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Yield a line for each module of an earlier run that is missing, or of whose mutants a smaller share is killed."""
    now = {result.module: result for result in results}
    for before in earlier:
        name, mutants = before["module"], before["mutants"]
        killed, after = sum(mutant["killed"] for mutant in mutants), now.get(name)
        if after is None:
            yield f"{name}: not run, before {killed} of {len(mutants)} killed"
        elif after.kills * len(mutants) < killed * len(after.mutants):
            text = "" if after.text == before["text"] else "; its text has changed, and so have the mutants"
            yield f"{name}: {after.kills} of {len(after.mutants)} killed, before {killed} of {len(mutants)}{text}"


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; return 1 where fewer mutants are killed than in the run that is compared with."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.mutation", description=(__doc__ or "").partition("\n")[0]
    )
    parser.add_argument("modules", nargs="*", default=MODULES, help="files; eleven of different folders if left out")
    parser.add_argument("--mutants", type=int, default=30, help="of each module")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--json", type=Path, help="file to write")
    parser.add_argument("--compare", type=Path, help="file of an earlier run")
    chosen = parser.parse_args(arguments)
    earlier = json.loads(chosen.compare.read_text(encoding="utf-8")) if chosen.compare else []
    for library in LIBRARIES:
        importlib.import_module(library)
    results = []
    for module in chosen.modules:
        results.append(measure(Path(module), chosen.mutants, chosen.seed))
        if chosen.json:
            chosen.json.write_text(json.dumps([asdict(result) for result in results], indent=1), encoding="utf-8")
    lost = [*losses(results, earlier)]
    sys.stdout.writelines(f"{line}\n" for line in (*table(results), *lost))
    return int(bool(lost))


if __name__ == "__main__":
    sys.exit(main())
