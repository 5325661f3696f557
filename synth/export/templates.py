"""The files of a project that are filled in, or the same for every stage: those below a folder of this package."""

from collections.abc import Mapping, Sequence
from importlib import resources
from typing import Any

import jinja2


def render(folder: str, facts: Mapping[str, Any], names: Sequence[str] = ()) -> dict[str, str]:
    """Return `{name: text}` of the files of a folder, or of `names` among them; templates, *.j2, lose their ending."""
    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("synth.export", folder),
        undefined=jinja2.StrictUndefined,
        keep_trailing_newline=True,
    )
    files = {}
    for file in resources.files("synth.export").joinpath(folder).iterdir():
        name = file.name.removesuffix(".j2")
        if file.is_dir() or (names and name not in names):
            continue
        is_template = file.name.endswith(".j2")
        files[name] = environment.get_template(file.name).render(facts) if is_template else file.read_text("utf-8")
    return files
