"""The code of the documentation: found on its pages, run, and its output held beside what the page shows.

    ```python        one example; the examples of a page share one namespace, from top to bottom
    ```text          what the example above it prints
    ```{code-block}  with a caption: a whole file, or with `diff` a change of a file, of a workspace

`python -m docs.pages PAGE...` runs pages and writes what their examples print into them.
"""

import ast
import contextlib
import io
import re
import sys
from pathlib import Path
from typing import Any

EXAMPLE = re.compile(r"^```python\n(?P<code>.*?)^```\n(?:\n?```text\n(?P<shown>.*?)^```\n)?", re.MULTILINE | re.DOTALL)
BLOCK = re.compile(
    r"^```{code-block} (?P<language>\w+)\n:caption: (?P<path>\S+)\n\n(?P<text>.*?^)```$", re.MULTILINE | re.DOTALL
)
PICTURE = re.compile(r"savefig\(\"([\w-]+\.svg)\"")


def run(text: str, folder: Path) -> tuple[dict[str, Any], list[tuple[str | None, str]]]:
    """Run a page's examples in a folder; return their namespace, and what each shows and prints."""
    session: dict[str, Any] = {}
    pairs: list[tuple[str | None, str]] = []
    for example in EXAMPLE.finditer(text):
        printed = io.StringIO()
        with contextlib.chdir(folder), contextlib.redirect_stdout(printed):
            _execute(example["code"], session)
        pairs.append((example["shown"], printed.getvalue()))
    return session, pairs


def _execute(code: str, session: dict[str, Any]) -> None:
    """Run one example; an expression on its own prints nothing, but a result of ours must show itself."""
    for node in ast.parse(code).body:
        if isinstance(node, ast.Expr):
            shown = eval(compile(ast.Expression(node.value), "example", "eval"), session)
            ours = type(shown).__module__.split(".")[0] == "synth"
            assert not ours or "object at 0x" not in repr(shown), f"{ast.unparse(node)} prints as {shown!r}"
        else:
            exec(compile(ast.Module([node], []), "example", "exec"), session)


def blocks(text: str, language: str | None = None) -> list[tuple[str, str]]:
    """Return (path, text) of the files, or of the changes of files for `diff`, that a page shows."""
    blocks_of_page = [(b["language"], b["path"], b["text"]) for b in BLOCK.finditer(text)]
    return [
        (path, body) for kind, path, body in blocks_of_page if kind == language or (language is None and kind != "diff")
    ]


def apply(text: str, folder: Path) -> None:
    """Write the files that a page shows to a workspace, then make its changes, in their order on the page."""
    for path, body in blocks(text):
        (folder / path).write_text(body, encoding="utf-8")
    for path, change in blocks(text, "diff"):
        lines = change.splitlines(keepends=True)
        before = "".join(line[1:] or "\n" for line in lines if line[0] != "+")
        after = "".join(line[1:] or "\n" for line in lines if line[0] != "-")
        whole = (folder / path).read_text(encoding="utf-8")
        assert whole.count(before) == 1, f"{path}: found {whole.count(before)} places, need one, for\n{before}"
        (folder / path).write_text(whole.replace(before, after), encoding="utf-8")


def rewrite(page: Path) -> None:
    """Write what the examples of a page print into the page."""
    text = page.read_text(encoding="utf-8")
    printed = iter([printed for _, printed in run(text, page.parent)[1]])

    def renew(example: re.Match[str]) -> str:
        output = next(printed)
        return f"```python\n{example['code']}```\n" + (f"\n```text\n{output}```\n" if output else "")

    page.write_text(EXAMPLE.sub(renew, text), encoding="utf-8")


def draw(folder: Path) -> None:
    """Run the pages whose pictures are missing, or older than the page."""
    for page in sorted(folder.rglob("*.md")):
        text = page.read_text(encoding="utf-8")
        pictures = [page.parent / name for name in PICTURE.findall(text)]
        if any(not p.exists() or p.stat().st_mtime < page.stat().st_mtime for p in pictures):
            run(text, page.parent)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        rewrite(Path(name))
