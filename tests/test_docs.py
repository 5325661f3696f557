"""What the documentation shows runs as it stands."""

import ast
import re
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[1] / "docs"
FENCE = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def run(text: str) -> dict[str, Any]:
    """Run the examples of a page, one after the other, in one namespace; each last expression prints itself."""
    session: dict[str, Any] = {}
    for code in FENCE.findall(text):
        for node in ast.parse(code).body:
            if isinstance(node, ast.Expr):
                shown = eval(compile(ast.Expression(node.value), "example", "eval"), session)
                assert "object at 0x" not in repr(shown), f"{ast.unparse(node)} prints as {shown!r}"
            else:
                exec(compile(ast.Module([node], []), "example", "exec"), session)
    return session


@pytest.mark.parametrize("page", sorted(DOCS.glob("*.md")), ids=lambda page: page.name)
def test_the_examples_run(page: Path) -> None:
    session = run(page.read_text(encoding="utf-8"))
    assert session["gain"].K[0, 1] == pytest.approx(-507.24, abs=0.005)


def test_a_broken_example_is_noticed() -> None:
    with pytest.raises(NameError):
        run("text\n\n```python\nx = missing\n```\n")
