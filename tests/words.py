"""The tree's vocabulary, counted: private words, unclear phrases, locals that do not say what they hold, participles.

A word of PRIVATE may stand neither in a name nor in prose. A name of PRIVATE_NAMES may not be defined: as a function,
a class, a module or a field. PHRASES may not stand in prose. Quotations in backticks of docs count as prose as well.
"""

import ast
import io
import re
import tokenize
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
FOLDERS = ("synth", "models", "designs", "benchmarks", "tests", "docs", "generated_c")
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


def private_definitions(text: str) -> set[str]:
    """Return the private names that a Python text defines as functions, classes or fields."""
    tree = ast.parse(text)
    classes = [node for node in ast.walk(tree) if isinstance(node, ast.ClassDef)]
    fields = [
        f.target.id for c in classes for f in c.body if isinstance(f, ast.AnnAssign) and isinstance(f.target, ast.Name)
    ]
    return {name.strip("_") for name in [*fields, *(c.name for c in classes), *functions(text)]} & set(PRIVATE_NAMES)


def functions(text: str) -> list[str]:
    """Return the names of all functions of a Python text, methods and inner ones included."""
    return [node.name for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]


def vague_locals(text: str) -> list[tuple[str, str]]:
    """Return (function, name) for each function of a Python text that binds a vague name, its arguments included."""
    return [
        (function.name, name)
        for function in ast.walk(ast.parse(text))
        if isinstance(function, ast.FunctionDef)
        for name in sorted(_bound(function) & VAGUE_LOCALS)
    ]


def _bound(function: ast.FunctionDef) -> set[str]:
    nodes = list(ast.walk(function))
    stored = {n.id for n in nodes if isinstance(n, ast.Name) and isinstance(n.ctx, ast.Store)}
    return stored | {n.arg for n in nodes if isinstance(n, ast.arg)}


def participles(text: str) -> set[str]:
    """Return the functions of a Python text whose names end in -ed, without tests."""
    return {name for name in functions(text) if name.endswith("ed") and not name.startswith("test_")}
