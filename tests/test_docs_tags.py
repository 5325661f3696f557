"""Each equation tag of the tree is explained on the page of the tags."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
TAG = re.compile(r"\b([FYK])\((\d+)\)(?:-\((\d+)\))?")
FOLDERS = ("synth", "models", "designs", "studies")


def numbers(text: str) -> set[tuple[str, int]]:
    """Return (paper, number) of each tag, a run F(14)-(17) as its members."""
    equations = set()
    for paper, first, last in TAG.findall(text):
        equations |= {(paper, k) for k in range(int(first), int(last or first) + 1)}
    return equations


def test_each_tag_of_the_tree_is_on_the_page() -> None:
    explained = numbers((ROOT / "docs" / "reference" / "equations.md").read_text(encoding="utf-8"))
    used = set()
    for folder in FOLDERS:
        for path in (ROOT / folder).rglob("*.py"):
            used |= numbers(path.read_text(encoding="utf-8"))
    assert used and used <= explained, sorted(used - explained)


def test_each_file_that_the_page_names_is_there() -> None:
    text = (ROOT / "docs" / "reference" / "equations.md").read_text(encoding="utf-8")
    paths = re.findall(r"`((?:synth|models|designs|studies)/[\w/]+(?:\.py|/))`", text)
    assert paths and [p for p in paths if not (ROOT / p).exists()] == []
