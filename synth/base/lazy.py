"""Names that a package exports and imports once they are used (PEP 562), read from the package's stub file.

The stub beside a package's ``__init__.py`` is the one list of its names, for users, editors and type checkers alike:

    from synth.analyse.operating_points import linearise as linearise      that function, imported when it is used
    __all__ = ["linearise"]                                             what type checkers take as exported
"""

import ast
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any


def exports(package: str, path: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Return ``__getattr__``, ``__dir__`` and ``__all__`` of the package with that name, whose ``__file__`` is `path`.

    The first raises AttributeError for a name that the stub does not list.
    """
    stub = ast.parse(Path(path).with_suffix(".pyi").read_text(encoding="utf-8"))
    sources = {
        alias.asname or alias.name: (node.module, alias.name)
        for node in stub.body
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }

    def get(name: str) -> Any:
        if name not in sources:
            raise AttributeError(f"module '{package}' has no attribute '{name}': {', '.join(sources)} are there")
        module, original = sources[name]
        # A stub names a subpackage by `from synth import analyse as analyse`.
        value = (
            import_module(f"{package}.{original}") if module == package else getattr(import_module(module), original)
        )
        setattr(sys.modules[package], name, value)
        return value

    return get, lambda: sorted({*vars(sys.modules[package]), *sources}), list(sources)
