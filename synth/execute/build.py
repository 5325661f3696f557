"""Build a controller from a Block: emit its C, compile it and load it, in one call."""

from dataclasses import replace

import numpy as np

from synth.block import Block
from synth.emit import write
from synth.execute import host


def compile_block(
    block: Block,
    scalar: type[np.floating] = np.float32,
    *,
    error: float | None = None,
    libm: bool = False,
) -> host.Controller:
    """Return the emitted C of a Block in a scalar type, compiled and loaded; arguments are those of `write.emit`.

    Raises EmitError as `write.emit`, and CompileError as `host.load`.
    """
    emitted = write.emit(block, scalar, libm=libm, error=error)
    loaded = host.load(emitted.files, emitted.manifest)
    return replace(loaded, source=host.Source(block, libm, error))
