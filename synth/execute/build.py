"""Build a controller from a Block: emit its C, compile it and load it, in one call."""

from dataclasses import replace

import numpy as np

from synth.block import Block
from synth.emit import write
from synth.errors import WiringError
from synth.execute import host
from synth.signals import signal_names


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


def vary(base: host.Controller, block: Block) -> host.Controller:
    """Return a variant of a controller, such as one with other gains, that runs in lanes without a compilation of C.

    Raises WiringError for a base whose Block is not known, and for a Block with other signals or initial states.
    """
    if base.source is None:
        raise WiringError(f"controller '{base.manifest['design']}' has no Block: make it with build.compile_block")
    if _interface(block) != _interface(base.source.block):
        raise WiringError(
            f"the variant of controller '{base.manifest['design']}' has other signals, states or initial values: "
            "a variant may differ in gains, bounds and equations alone"
        )
    return replace(base, source=base.source._replace(block=block), base=base.base or base)


def _interface(block: Block) -> tuple[object, ...]:
    states = tuple((s.name, s.initial, s.integer) for s in block.states)
    return block.name, block.time, signal_names(block.inputs), signal_names(block.outputs), states
