"""How Sphinx makes the site: Markdown by MyST, the reference from docstrings, pictures from the pages' own code."""

import os
import re
import sys
from importlib.metadata import version as installed
from pathlib import Path

project = "synth"
version = installed("synth-stage")
extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3
html_theme = "furo"
html_title = "synth"
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "none"  # docstrings give shapes and units, which types do not
autodoc_preserve_defaults = True
add_module_names = False

DOCS = Path(__file__).parent
sys.path.insert(0, str(DOCS.parent))
PACKAGE = DOCS.parent / "synth"


def write_reference(app):
    """Write a page for each folder of the toolkit, with its modules as sections."""
    api = DOCS / "reference" / "api"
    api.mkdir(exist_ok=True)
    for folder in (PACKAGE, *sorted(p.parent for p in PACKAGE.glob("*/**/__init__.py"))):
        package = ".".join(folder.relative_to(DOCS.parent).parts)
        modules = [f"{package}.{path.stem}" for path in sorted(folder.glob("*.py")) if path.stem[:2] != "__"]
        sections = [f"{name}\n{'-' * len(name)}\n\n.. automodule:: {name}\n" for name in modules]
        page = "\n".join([f"{package}\n{'=' * len(package)}\n\n.. automodule:: {package}\n", *sections])
        path = api / f"{package}.rst"
        if not path.exists() or path.read_text(encoding="utf-8") != page:
            path.write_text(page, encoding="utf-8")


def draw_pictures(app):
    """Make the pictures of the pages by running the code that each page shows."""
    from docs import pages

    os.environ.setdefault("MPLBACKEND", "svg")
    pages.draw(DOCS)


def plain(app, what, name, obj, options, lines):
    """Show a docstring as it is written: where lines are indented, in equations and tables, every blank counts."""
    paragraphs = "\n".join(lines).strip("\n").split("\n\n")
    lines[:] = [line for text in paragraphs for line in [*_shown(text.split("\n")), ""]]


def _shown(paragraph):
    if any(line.startswith(" ") for line in paragraph):
        return [".. code-block:: text", "", *(f"   {line}" for line in paragraph)]
    return [_escaped(line) for line in paragraph]


def _escaped(line):
    """Let signs of reStructuredText stand for themselves, and show what is in backquotes as code."""
    parts = re.split(r"(`[^`]+`)", line.replace("``", "`"))
    return "".join(f"`{p}`\\ " if p.startswith("`") else re.sub(r"([*|_\\<>`])", r"\\\1", p) for p in parts)


def setup(app):
    app.connect("builder-inited", write_reference)
    app.connect("builder-inited", draw_pictures)
    app.connect("autodoc-process-docstring", plain)
