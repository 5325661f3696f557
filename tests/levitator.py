"""The stage of tests/workspaces under two laws composed by hand, imported beside the designs of this repository."""

import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "workspaces" / "levitator"


def design() -> Any:
    """Return the module that declares it."""
    if str(FOLDER) not in sys.path:
        sys.path.append(str(FOLDER))
    from designs.levitator_pid import design

    return design
