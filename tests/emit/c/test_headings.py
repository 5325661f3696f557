"""Headings of a step's sections, and constants at the head of the one section that reads them."""

import re
from collections import Counter
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import casadi as ca
import pytest

from synth.block import Block, State, Step, build
from synth.composition import compose
from synth.emit.c.lines import Line
from synth.emit.c.sections import with_constants
from synth.emit.write import emit
from tests.emit.dyadic import TIME, signal
from tests.emit.passes.test_guards import F32

GENERATED = Path(__file__).parents[3] / "generated_c"
SOURCES = sorted(path.name for path in GENERATED.iterdir() if (path / f"{path.name}.c").exists())
COMMENT = re.compile(r"^ *(/\*.*?\*/)", re.MULTILINE | re.DOTALL)
EQUATION = re.compile(r"^ \* {5}(\w+(?:\(\w+\))? = .*)$", re.MULTILINE)


def equations_printed_twice(text: str) -> list[tuple[str, str]]:
    """Return the title and the first row of each equation that is printed twice under one title."""
    pairs: Counter[tuple[str, str]] = Counter()
    for comment in COMMENT.findall(text):
        body = "\n".join(f" {row.strip()}" for row in comment.splitlines())
        title = comment.splitlines()[0].strip("/* ").removesuffix(" (continued)").partition(":")[0]
        pairs.update((title, row) for row in EQUATION.findall(body))
    return [pair for pair, count in pairs.items() if count > 1]


@pytest.mark.parametrize("name", SOURCES)
def test_equations_of_a_section_stand_once(name: str) -> None:
    text = (GENERATED / name / f"{name}.c").read_text()
    assert equations_printed_twice(text) == []
    section = next(
        c for c in COMMENT.findall(text) if EQUATION.search("\n".join(f" {r.strip()}" for r in c.split("\n")))
    )
    assert equations_printed_twice(text + section)


@pytest.mark.parametrize("name", SOURCES)
def test_a_section_that_continues_was_opened_before(name: str) -> None:
    titles = [c.split("\n")[0].strip("/* ") for c in COMMENT.findall((GENERATED / name / f"{name}.c").read_text())]
    for k, title in enumerate(titles):
        opened = title.removesuffix(" (continued)")
        assert opened == title or opened in titles[:k], title
    assert not [title for title in titles if title.endswith((": ", ":"))]


def declare(name: str) -> Callable[[str], Sequence[str]]:
    return partial(lambda text, indent: [indent + text], f"static const float {name} = 1.0f;")


def test_a_constant_stands_at_the_head_of_the_only_section_that_reads_it() -> None:
    body = [
        Line("    /* first */", "first"),
        Line("    const float a = own * shared;", "first"),
        Line("    if (a > 0.0f) {"),
        Line("        /* second */", "second"),
        Line("        b = inner + shared;", "second"),
        Line("    }"),
        Line("    c = outer * b;", "first"),
    ]
    head, lines = with_constants(body, {name: declare(name) for name in ("own", "shared", "inner", "outer")})
    texts = [line.text.strip() for line in lines]
    assert [line.text for line in head] == ["    static const float shared = 1.0f;"]
    assert texts.index("static const float own = 1.0f;") == texts.index("/* first */") + 1
    assert texts.index("static const float inner = 1.0f;") == texts.index("/* second */") + 1
    assert "        static const float inner = 1.0f;" in [line.text for line in lines]
    assert texts.index("static const float outer = 1.0f;") == texts.index("/* first */") + 2


def servo(name: str, others: int) -> Block:
    """Return a Block of `others` states and a limited output."""

    def law(u: Any, x: Any, k: Any) -> Step:
        states = {f"s{i}": ca.fmax(ca.fmin(x[f"s{i}"] * 0.5 + u["e"] * (i + 1), 4), -4) for i in range(others)}
        return Step({f"w_{name}": sum(x[s] for s in states) * u["e"]}, states)

    states = [State(signal(f"s{i}", -4, 4), 0) for i in range(others)]
    return build(
        name, TIME, law, inputs=[signal("e")], outputs=[signal(f"w_{name}", -1e8, 1e8)], states=states, tag="servo"
    )


def test_each_block_has_a_section_with_its_equations() -> None:
    block = compose("pair", [servo("wide", 5), servo("slim", 4)], inputs=["e"], outputs=["w_wide", "w_slim"])
    text = emit(block, F32).files["pair.c"]
    titles = [c.split("\n")[0].strip("/* ") for c in COMMENT.findall(text)]
    assert [t for t in titles if t.startswith(("wide", "slim"))] == ["wide: servo", "slim: servo"]
    assert equations_printed_twice(text) == []
    assert len(re.findall(r"\* {5}w_(?:wide|slim) = ", text)) == 2
