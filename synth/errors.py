"""Exceptions. Each message gives the quantity, the value found, the value needed and the remedy."""

import os
import sysconfig
import traceback
from pathlib import Path

_TOOLKIT = Path(__file__).parent
_LIBRARIES = tuple(Path(sysconfig.get_path(name)) for name in ("stdlib", "platstdlib", "purelib", "platlib"))


class SynthError(Exception):
    """Base class of every error that this package raises on purpose."""


class SignalError(SynthError):
    """A signal, unit or parameter is declared wrongly or not known."""


class TimingError(SynthError):
    """Continuous and sampled time, or two sample periods, were mixed."""


class WiringError(SynthError):
    """Blocks cannot be wired: a missing signal, two drivers, different units or an algebraic loop."""


class ModelError(SynthError):
    """A model lacks a requested property: no trim point, an unstabilisable mode, a singular decoupling matrix."""


class NoEquilibriumError(ModelError):
    """A closed loop has no equilibrium that could be found: usually it is not stable."""


class EmitError(SynthError):
    """A Block cannot be written as C."""


class CompileError(SynthError):
    """No compiler, or the compiler refused the source."""


class DesignError(SynthError):
    """A design or the workspace around it is incomplete or not found."""


class ContentError(SynthError):
    """A value or its source has no content digest, and no result can be cached under it."""


def design_lines(error: BaseException) -> list[str]:
    """Return as "file:line" the lines of a design that the traceback of an exception leads through, innermost last.

    Code of this package is "" in the list; that of Python and of installed packages is left out.
    """
    lines = []
    for frame in traceback.extract_tb(error.__traceback__):
        file = Path(frame.filename)
        if file.is_relative_to(_TOOLKIT):
            lines.append("")
        elif file.is_file() and not any(file.is_relative_to(library) for library in _LIBRARIES):
            lines.append(f"{os.path.relpath(file)}:{frame.lineno}")
    return lines
