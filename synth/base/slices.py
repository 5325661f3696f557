"""Program slicing: the statements that a function may run, from the syntax trees of its module and its imports.

    slice(f) = the least set that holds f's own statement, and with a statement every top-level statement that it names,
               in its module or by way of an import, and all that runs when a module of the slice is imported

The digest of a slice changes when the function may compute something else, and stays when unrelated functions beside
it change. A module that is passed on as a whole, or read by a name that it does not define, counts whole. Data files
beside the modules (`.toml`, `.c`, ...) count on request. Comments do not count; docstrings do.

The slice follows imports of `synth` and of the packages of the workspace; other packages count by their versions. It
does not see a name in a string: formulas of an audit call functions of modules that are named as a whole.

Source: M. Weiser, Program slicing, IEEE Trans. Software Engineering 10 (1984), 352-357.

Parsed sources of the toolkit and of a workspace: top-level statements of a module, names in them, and imports.

A process reads a module once, since an imported module does not change with its file. The summary of a syntax tree is
cached under the digest of the text.
"""

import ast
import functools
import hashlib
import inspect
import sys
import sysconfig
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from synth.base import store
from synth.errors import ContentError

TOOLKIT = Path(__file__).resolve().parents[1]
BARE = ""  # instead of a bound name, for a statement that does more than bind names

Paths = tuple[tuple[str, ...], ...]  # dotted names, split at the dots


@dataclass(frozen=True)
class Statement:
    """A top-level statement: the digest of its text, the dotted names in it, and the names that it imports.

    `defines` is True for a function or a class.
    """

    digest: str
    defines: bool
    paths: Paths
    imports: tuple[tuple[str, str], ...]


@dataclass(frozen=True, eq=False)
class Module:
    """A parsed module: its statements by the name that they bind, the others (BARE), and its imports by name.

    `exports` are the names that a package imports once they are used, from its stub, see `lazy`.
    """

    path: Path
    statements: dict[str, tuple[Statement, ...]]
    imports: dict[str, str]
    exports: dict[str, str]


@cache
def module_of(root: Path, name: str) -> Module | None:
    """Return a module of the toolkit or of the workspace at `root`, None for any other."""
    first, *others = name.split(".")
    base = TOOLKIT if first == "synth" else root / first
    path = base.joinpath(*others)
    if first != "synth" and root == TOOLKIT.parent and not ((root / "designs").is_dir() and (root / first).exists()):
        return None
    for file in (path.with_name(f"{path.name}.py"), path / "__init__.py"):
        if file.is_file():
            return parse(file, name)
    return parse(None, name) if path.is_dir() and path != root else None


@cache
def parse(path: Path | None, name: str) -> Module:
    """Read a module, once in a process."""
    if path is None:  # a folder without __init__.py
        return Module(Path(), {}, {}, {})
    content = text(path)
    version = hashlib.sha256(Path(__file__).read_bytes() + sys.version.encode()).digest()
    key = hashlib.sha256(version + f"{name} {path.name} ".encode() + content).hexdigest()
    summary = store.fetch(key, lambda: _summary(ast.parse(content), name, path.name == "__init__.py"))
    return Module(path, *summary, _exports(path, name))


def _exports(path: Path, name: str) -> dict[str, str]:
    stub = path.with_suffix(".pyi")
    if path.name != "__init__.py" or not stub.is_file():
        return {}
    return dict(_imports(ast.parse(text(stub)).body, name, True))


@cache
def text(path: Path) -> bytes:
    """Return the content of a file at the first call."""
    return path.read_bytes()


def _summary(tree: ast.Module, name: str, package: bool) -> tuple[dict[str, tuple[Statement, ...]], dict[str, str]]:
    """Return the statements of a module by the name that they bind, and its imports by name."""
    statements: dict[str, tuple[Statement, ...]] = {}
    for node in tree.body:
        if isinstance(node, ast.Import | ast.ImportFrom) or _is_docstring(node):
            continue
        made = statement_of(node, name, package)
        for bound in _bound_names(node) or (BARE,):
            statements[bound] = (*statements.get(bound, ()), made)
    inside = [item for s in statements.get(BARE, ()) for item in s.imports]
    return statements, dict([*inside, *_imports(tree.body, name, package)])


def statement_of(node: ast.AST, name: str, package: bool) -> Statement:
    """Read a statement, or a lambda, of the module called `name`; `package` marks an `__init__.py`."""
    inside = [n for n in ast.walk(node) if isinstance(n, ast.Import | ast.ImportFrom)]
    digest = hashlib.sha256(ast.unparse(node).encode()).hexdigest()
    defines = isinstance(node, ast.FunctionDef | ast.ClassDef)
    return Statement(digest, defines, tuple(sorted(set(_paths(node)))), tuple(_imports(inside, name, package)))


def _is_docstring(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _bound_names(node: ast.stmt) -> tuple[str, ...]:
    """Return the names that a statement binds, none for a statement that does more."""
    if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        return (node.name,)
    targets: list[ast.expr] = []
    if isinstance(node, ast.Assign):
        targets = node.targets
    elif isinstance(node, ast.AnnAssign):
        targets = [node.target]
    flat = [e for t in targets for e in (t.elts if isinstance(t, ast.Tuple | ast.List) else [t])]
    return tuple(e.id for e in flat if isinstance(e, ast.Name)) if all(isinstance(e, ast.Name) for e in flat) else ()


def _paths(node: ast.AST) -> Iterator[tuple[str, ...]]:
    """Yield each dotted name in a tree, in full length."""
    chain: list[str] = []
    inner: ast.AST = node
    while isinstance(inner, ast.Attribute):
        chain.append(inner.attr)
        inner = inner.value
    if isinstance(inner, ast.Name):
        yield (inner.id, *reversed(chain))
        return
    for child in ast.iter_child_nodes(inner):
        yield from _paths(child)


def _imports(nodes: Sequence[ast.AST], name: str, package: bool) -> Iterator[tuple[str, str]]:
    """Yield (name, dotted target) of import statements in a module."""
    for node in nodes:
        if isinstance(node, ast.Import):
            for a in node.names:
                top = a.name.split(".")[0]
                yield (a.asname, a.name) if a.asname else (top, top)
            yield from ((f".{a.name}", a.name) for a in node.names)  # loaded without a name
        elif isinstance(node, ast.ImportFrom):
            base = name.split(".")[: len(name.split(".")) - node.level + package] if node.level else []
            source = ".".join([*base, *([node.module] if node.module else [])])
            yield from ((a.asname or a.name, f"{source}.{a.name}") for a in node.names)


DATA = (".toml", ".c", ".h", ".j2", ".css", ".md", ".json", ".csv")
WHOLE = "*"  # instead of the name of one statement: all of a module; BARE: the statements that run at its import

Place = tuple[str, str]  # module and name


def digest(function: Callable[..., Any] | type, data: bool = False) -> str:
    """Return the digest of the slice of a function or class; with `data` also of data files beside its modules.

    Raises ContentError where its source is not in a file, or where a function of the slice has been replaced.
    """
    entry = _entry(function)
    lines = [_digest(entry, data), *_live(entry)]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


@functools.cache
def _places(entry: "_Entry") -> frozenset[Place]:
    return _closure(entry.root, entry.start())


@functools.cache
def _digest(entry: "_Entry", data: bool) -> str:
    start, places = entry.start(), _places(entry)
    lines = [f"{place} {s.digest}" for place in sorted(places) for s in _at(entry.root, place)]
    lines += [s.digest for s in start if isinstance(s, Statement)]
    if data:
        modules = {module for module, _ in places}
        lines += [line for module in sorted(modules) for line in _beside(entry.root, module)]
    return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _live(entry: "_Entry") -> Iterator[str]:
    """Yield the present numbers and texts of a slice: a program, or a test, may set them after the import."""
    root, last_seen = entry.root, _last_seen(entry.root)
    for place in _bindings(entry):
        value = getattr(sys.modules.get(place[0]), place[1], None)
        seen, line = last_seen.get(place, _NEVER)
        if value is not seen:
            line = _line(root, place, value)
            if not _may_change(value):
                last_seen[place] = value, line
        if line:
            yield line


_NEVER = (object(), "")


@functools.cache
def _last_seen(root: Path) -> dict[Place, tuple[Any, str]]:
    """Return by place its value at the last look, and the line of that: one dictionary for a folder."""
    return {}


@functools.cache
def _bindings(entry: "_Entry") -> tuple[Place, ...]:
    return tuple(sorted(place for place in _places(entry) if place[1] not in (WHOLE, BARE)))


def _may_change(value: Any) -> bool:
    """Return whether what is in a value may change while it stays the same object."""
    return isinstance(value, dict | list | set) or (isinstance(value, tuple) and any(map(_may_change, value)))


def _line(root: Path, place: Place, value: Any) -> str:
    """Return the line of a number or a text at a place, "" for another value."""
    if inspect.isfunction(value) or isinstance(value, type):
        _require_original(root, place, value)
        return ""
    plain = _plain(value)
    return "" if plain is None else f"{place[0]} {place[1]} {plain}"


def _require_original(root: Path, place: Place, value: Any) -> None:
    """Raise ContentError where a function or class has replaced the one that a statement defines."""
    inner, name = inspect.unwrap(value), ".".join(place)
    actual = f"{inner.__module__}.{inner.__qualname__}"
    if actual != name and any(s.defines for s in _at(root, place)):
        raise ContentError(f"slice: found {actual} in place of {name}, need what its source says: put it back")


def _plain(value: Any) -> str | None:
    """Return a text for numbers, texts and collections of them, None for anything else."""
    if isinstance(value, bool | int | float | complex | str | bytes):
        return repr(value)
    if isinstance(value, dict):
        value = [part for item in value.items() for part in item]
    if not isinstance(value, list | tuple | set | frozenset):
        return None
    parts = [_plain(v) or type(v).__name__ for v in value]
    return f"({', '.join(sorted(parts) if isinstance(value, set | frozenset) else parts)})"


def is_followed(function: Callable[..., Any] | type) -> bool:
    """Return whether the source of a function or class counts; Python and installed packages have versions instead."""
    path = _file(inspect.unwrap(function))
    if path is None:
        return function.__module__ != "builtins"
    return path.is_relative_to(TOOLKIT) or not any(map(path.is_relative_to, _installation_folders()))


@functools.cache
def _installation_folders() -> tuple[Path, ...]:
    return tuple(Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "purelib", "platlib"))


@dataclass(frozen=True)
class _Entry:
    """The start of a slice: a top-level statement of a module, or the lambdas in one of its lines."""

    module: str
    path: Path
    top: str
    line: int

    @functools.cached_property
    def root(self) -> Path:
        """The folder that holds the module's package."""
        return self.path.parents[self.module.count(".") + (self.path.name == "__init__.py")]

    def start(self) -> list[Place | Statement]:
        """Return the places that begin the slice, and the statements that are lambdas."""
        parsed = parse(self.path, self.module)
        if self.top != "<lambda>":
            return [(self.module, self.top if self.top in parsed.statements else WHOLE), (self.module, BARE)]
        lambdas = [
            n for n in ast.walk(ast.parse(text(self.path))) if isinstance(n, ast.Lambda) and n.lineno == self.line
        ]
        return [(self.module, BARE), *(statement_of(n, self.module, False) for n in lambdas)]


def _entry(function: Callable[..., Any] | type) -> _Entry:
    inner = inspect.unwrap(function.func if isinstance(function, functools.partial) else function)
    module, top = inner.__module__, inner.__qualname__.split(".")[0]
    path = _file(inner)
    if path is None:
        raise ContentError(f"slice of {module}.{top}: found no file with its source, need one: import it from a file")
    line = inner.__code__.co_firstlineno if top == "<lambda>" else 0
    return _Entry(module, path, top, line)


def _file(function: Callable[..., Any] | type) -> Path | None:
    """Return the file with the source of a function or class, None for a built-in or one typed at a prompt."""
    try:
        return _resolve(inspect.getfile(function))
    except (TypeError, OSError):
        return None


@functools.cache
def _resolve(file: str) -> Path | None:
    path = Path(file).resolve()
    return path if path.is_file() else None


def _closure(root: Path, start: Sequence[Place | Statement]) -> frozenset[Place]:
    """Return the places that can be reached from the start of a slice."""
    waiting = {each for each in start if not isinstance(each, Statement)}
    module = next(each for each in start if not isinstance(each, Statement))[0]
    waiting |= {place for each in start if isinstance(each, Statement) for place in _named_places(root, module, each)}
    places: set[Place] = set()
    while waiting:
        place = waiting.pop()
        places.add(place)
        waiting |= _next(root, place) - places
    return frozenset(places)


@functools.cache
def _next(root: Path, place: Place) -> frozenset[Place]:
    """Return the places that the statements at a place name, and those that the import of its module runs."""
    name = place[0]
    module = module_of(root, name)
    if module is None:
        return frozenset()
    imported = [(t, BARE) for target in module.imports.values() for t in _targets(target)]
    imported += [(target[:-2], WHOLE) for target in module.imports.values() if target.endswith(".*")]
    packages = [(".".join(name.split(".")[:k]), BARE) for k in range(1, name.count(".") + 1)]
    reached = [p for s in _at(root, place) for p in _named_places(root, name, s)]
    return frozenset([(name, BARE), *imported, *packages, *reached])


@functools.cache
def _targets(target: str) -> tuple[str, ...]:
    """Return the modules that the import of a dotted name may load."""
    parts = target.split(".")
    return tuple(".".join(parts[:k]) for k in range(1, len(parts) + 1))


def _at(root: Path, place: Place) -> tuple[Statement, ...]:
    module = module_of(root, place[0])
    if module is None:
        return ()
    if place[1] == WHOLE:
        return tuple(s for statements in module.statements.values() for s in statements)
    return module.statements.get(place[1], ())


def _named_places(root: Path, name: str, statement: Statement) -> Iterator[Place]:
    """Yield the places that a statement of a module names."""
    local, module = dict(statement.imports), module_of(root, name)
    for target in local.values():
        yield from ((t, BARE) for t in _targets(target))
    for first, *attributes in statement.paths:
        if first in local:
            yield from _resolve_attributes(root, local[first], attributes)
        elif module and first in module.statements:
            yield name, first
        elif module and first in module.imports:
            yield from _resolve_attributes(root, module.imports[first], attributes)


def _resolve_attributes(root: Path, target: str, attributes: Sequence[str]) -> Iterator[Place]:
    """Yield what `target.attribute. ...` names, where the target is a module or a name in one."""
    if module_of(root, target) is None:
        parent, _, last = target.rpartition(".")
        if parent and module_of(root, parent) is not None:
            yield from _resolve_name(root, parent, last, attributes)
        return
    if not attributes:
        yield target, WHOLE
        return
    deeper = f"{target}.{attributes[0]}"
    if module_of(root, deeper) is not None:
        yield from _resolve_attributes(root, deeper, attributes[1:])
    else:
        yield from _resolve_name(root, target, attributes[0], attributes[1:])


def _resolve_name(root: Path, name: str, binding: str, attributes: Sequence[str]) -> Iterator[Place]:
    """Yield the statement that binds a name in a module, the one that it is imported from, or the module whole."""
    module = module_of(root, name)
    if module and binding in module.statements:
        yield name, binding
    elif module and binding in module.imports:
        yield from _resolve_attributes(root, module.imports[binding], attributes)
    elif module and binding in module.exports:
        yield from _resolve_attributes(root, module.exports[binding], attributes)
    else:
        yield name, WHOLE


def _beside(root: Path, name: str) -> Iterator[str]:
    """Yield a line for each data file in the folder of a module."""
    module = module_of(root, name)
    if module is not None and module.path.is_file():
        yield from _data(module.path.parent)


@functools.cache
def _data(folder: Path) -> tuple[str, ...]:
    files = sorted(p for p in folder.iterdir() if p.suffix in DATA and p.is_file())
    return tuple(f"{p.name} {hashlib.sha256(p.read_bytes()).hexdigest()}" for p in files)
