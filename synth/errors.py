"""Exceptions. Each message gives the quantity, the value found, the value needed and the remedy."""


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
