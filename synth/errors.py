"""What can go wrong, by kind. Each message names the quantity, what was found, what is needed and the mend."""


class SynthError(Exception):
    """Base of every error that this package raises on purpose."""


class SignalError(SynthError):
    """A signal, unit or parameter is declared wrongly or not known."""


class TimingError(SynthError):
    """Continuous and sampled time, or two sample periods, were mixed."""


class WiringError(SynthError):
    """Blocks cannot be wired: a missing signal, two drivers, unlike units or an algebraic loop."""


class ModelError(SynthError):
    """A model has no property that was asked for: no trim, an unstabilisable mode, a singular decoupling matrix."""


class EmitError(SynthError):
    """A Block cannot be written as C."""


class CompileError(SynthError):
    """No compiler, or the compiler refused the source."""


class DesignError(SynthError):
    """A design or the workspace around it is incomplete or not found."""


class ContentError(SynthError):
    """A value or its source cannot be compared with another by content, so that nothing can be kept under it."""
