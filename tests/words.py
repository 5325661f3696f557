"""The tree's vocabulary, counted: private words, unclear phrases, locals that do not say what they hold, participles.

A word of PRIVATE may stand neither in a name nor in prose. A name of PRIVATE_NAMES may not be defined: as a function,
a class, a module or a field. PHRASES may not stand in prose. Quotations in backticks of docs count as prose as well.
"""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[1]
FOLDERS = ("synth", "models", "designs", "studies", "benchmarks", "tests", "docs", "generated_c")
TEXTS = (".md", ".toml", ".j2", ".c", ".h", ".json", ".css")
ITSELF = ("tests/words.py", "tests/test_words.py")

PRIVATE = [
    "told",
    "leaning",
    "firm",
    "surprise",
    "astray",
    "telling",
    "Ahead",
    "Judged",
    "judged",
    "fleet",
    "Stirred",
    "SEVERE",
    "own_ways",
    "PUSHED",
    "belief",
    "hardly",
    "rival",
    "rivals",
    "shaken",
    "anew",
    "cornered",
]
PRIVATE_NAMES = [
    "found",
    "Found",
    "Kind",
    "follow",
    "settled",
    "certain",
    "turn",
    "apart",
    "expected",
    "spare",
    "declared",
    "near",
    "ahead",
    "Made",
    "MADE",
    "Spread",
    "shares",
    "reach",
    "heights",
    "reading",
    "Reading",
    "names",
    "wound",
    "filtered",
    "shipped",
    "hanging",
    "hardly_moved",
    "sees",
    "placed",
    "drawn",
    "moved",
    "turned",
    "opened",
    "given",
    "wanted",
    "own",
    "rest",
    "gone",
    "again",
]
PHRASES = (
    r"stands? twice",
    r"is no (finite |positive |whole )?number",
    r"is unlike",
    r"were it not",
    r"that which",
    r"for ever\b",
)
VAGUE_LOCALS = frozenset({"found", "given", "wanted", "own", "told"})


def sources(suffixes: tuple[str, ...]) -> Iterator[Path]:
    """Yield the files with these suffixes in the tree's folders and beside them, without this table."""
    files = [*ROOT.glob("*.md"), *(path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*")))]
    yield from (p for p in files if p.suffix in suffixes and p.relative_to(ROOT).as_posix() not in ITSELF)


def words(text: str) -> set[str]:
    """Return the words of a text: names as they are, and their parts between underscores and before capitals."""
    names = set(re.findall(r"[A-Za-z_][A-Za-z0-9_]*", text))
    return names | {part for name in names for part in name.split("_")}


def private_words(text: str) -> set[str]:
    """Return the private words that stand in a text."""
    return words(text) & set(PRIVATE)


def phrases(text: str) -> set[str]:
    """Return the unclear phrases that stand in a text, across the ends of its lines."""
    return {match[0] for phrase in PHRASES for match in re.finditer(phrase, " ".join(text.split()))}


def prose(text: str) -> str:
    """Return the comments and strings of a Python text."""
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    return " ".join(t.string.lstrip("# ") for t in tokens if t.type in (tokenize.COMMENT, tokenize.STRING))


class Definitions(NamedTuple):
    """What a Python text defines: functions, classes, fields, and for each function the vague names that it binds."""

    functions: tuple[str, ...]
    classes: tuple[str, ...]
    fields: tuple[str, ...]
    vague: tuple[tuple[str, str], ...]


@cache
def definitions(text: str) -> Definitions:
    """Return what a Python text defines; methods and inner functions are functions, too."""
    nodes = list(ast.walk(ast.parse(text)))
    functions = [node for node in nodes if isinstance(node, ast.FunctionDef)]
    classes = [node for node in nodes if isinstance(node, ast.ClassDef)]
    members = [f.target for c in classes for f in c.body if isinstance(f, ast.AnnAssign)]
    vague = [(f.name, name) for f in functions for name in sorted(_bound(f) & VAGUE_LOCALS)]
    return Definitions(
        tuple(f.name for f in functions),
        tuple(c.name for c in classes),
        tuple(target.id for target in members if isinstance(target, ast.Name)),
        tuple(vague),
    )


def private_definitions(text: str) -> set[str]:
    """Return the private names that a Python text defines as functions, classes or fields."""
    defined = definitions(text)
    return {name.strip("_") for name in [*defined.fields, *defined.classes, *defined.functions]} & set(PRIVATE_NAMES)


def vague_locals(text: str) -> list[tuple[str, str]]:
    """Return (function, name) for each function of a Python text that binds a vague name, its arguments included."""
    return list(definitions(text).vague)


def _bound(function: ast.FunctionDef) -> set[str]:
    nodes = list(ast.walk(function))
    stored = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    return stored | {n.arg for n in nodes if isinstance(n, ast.arg)}


def participles(text: str) -> set[str]:
    """Return the functions of a Python text whose names end in -ed, without tests."""
    return {name for name in definitions(text).functions if name.endswith("ed") and not name.startswith("test_")}
