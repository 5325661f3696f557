"""Layout of the structs of emitted C: compile-time assertions that the headers agree with the manifest."""

from collections.abc import Mapping
from typing import Any

from synth.errors import DesignError

_LAYOUT = """#include <stddef.h>
#include <stdint.h>
{includes}
#pragma GCC diagnostic error "-Wincompatible-pointer-types"
#pragma GCC diagnostic error "-Wpointer-sign"
#define AGREES(claim, holds) typedef char claim[(holds) ? 1 : -1]
{claims}
"""


def assertions(files: Mapping[str, str], manifest: Mapping[str, Any]) -> str:
    """Return compile-time assertions in C that the headers lay out the structs as the manifest states.

    Raises DesignError when there is no header.
    """
    headers = sorted(name for name in files if name.endswith(".h"))
    if not headers:
        raise DesignError(f"emitted C: found {sorted(files)}, need the header beside the source: add the .h file")
    structs = manifest["structs"]
    return _LAYOUT.format(
        includes="\n".join(f'#include "{name}"' for name in headers),
        claims="\n".join(line for role in structs for line in _claims(role, structs[role])),
    )


def _claims(role: str, struct: Mapping[str, Any]) -> list[str]:
    """Return the layout of a struct as compile-time assertions; the compiler prints the name of one that fails."""
    T, size = struct["type"], struct["size"]
    lines = [f"AGREES(manifest_{role}_has_{size}_bytes, sizeof({T}) == {size});"]
    for field in struct["fields"]:
        name, offset, count, ctype = (field[key] for key in ("name", "offset", "count", "ctype"))
        path = field.get("path", name)
        member, address = f"manifest_{role}_{name}", "" if count > 1 else "&"
        lines += [
            f"AGREES({member}_at_{offset}, offsetof({T}, {path}) == {offset});",
            f"AGREES({member}_has_{count}, sizeof((({T} *)0)->{path}) == {count} * sizeof({ctype}));",
            f"static inline const {ctype} *{member}_is_{ctype}(const {T} *s) {{ return {address}s->{path}; }}",
        ]
    return lines
