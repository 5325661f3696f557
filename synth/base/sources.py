"""Parsed sources of the toolkit and of a workspace: top-level statements of a module, names in them, and imports.

A process reads a module once, since an imported module does not change with its file. The summary of a syntax tree is
cached under the digest of the text.
"""

import ast
import hashlib
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from synth.base import store

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
def module(root: Path, name: str) -> Module | None:
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
        made = statement(node, name, package)
        for bound in _bound_names(node) or (BARE,):
            statements[bound] = (*statements.get(bound, ()), made)
    inside = [item for s in statements.get(BARE, ()) for item in s.imports]
    return statements, dict([*inside, *_imports(tree.body, name, package)])


def statement(node: ast.AST, name: str, package: bool) -> Statement:
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
