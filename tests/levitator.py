"""The levitator under two laws: the shipped `levitator_2dof`, and PID composed by hand in a workspace of the tests.

Both take the physics from models/levitator.py.
"""

import importlib
import sys
from pathlib import Path
from typing import Any

FOLDER = Path(__file__).parent / "workspaces" / "levitator"


def design(name: str = "levitator_pid") -> Any:
    """Return the module that declares a design."""
    if str(FOLDER) not in sys.path:
        sys.path.append(str(FOLDER))
    return importlib.import_module(f"designs.{name}.design")


def axes() -> Any:
    """Return the laws of z and x of the tuned design at the initial values of its free parameters."""
    tuned = design("levitator_2dof")
    return tuned.axes({free.name: free.value for free in tuned.FREE})
