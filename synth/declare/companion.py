"""Blocks beside the controller of a stage: companions, which are emitted with it, and the drive of its plant.

sensors, set-points --> controller --> drive, such as a commutation --> amplifiers --> plant
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from synth.block import Block
from synth.errors import WiringError
from synth.plant import Plant

# A step (states, inputs) or (states, inputs, bounds) -> (next states, outputs, fault words): see `verify.agree`.
Reference = Callable[..., tuple[Mapping[str, Any], Mapping[str, Any], Any]]
Gains = Callable[[type[np.floating]], Mapping[str, Any]]  # scalar type -> what gains.json says


@dataclass(frozen=True, eq=False)
class Companion:
    """A Block that is emitted beside the controller, as the commutation of a motor is; `make` builds it once used.

    With a `reference`, a step of the independent NumPy witness, the verification compares its witnesses like those of
    the controller, outputs relative to max(`floor`, |output|), by default to their ranges; `label` is its name there,
    by default that of the Block.

    `inputs` returns its inputs (N,) by name for test vectors, from the recorded inputs and outputs of the controller;
    by default each is the output or else the input of the controller with its name. `gains` returns the document of its
    gains.json. `header_notes` are sentences of its C's header, by default those of the stage. `sequences` returns, for
    the compiled C, further steps that cover its decisions.
    """

    name: str
    make: Callable[[], Block]
    reference: Reference | None = field(default=None, kw_only=True)
    floor: float | None = field(default=None, kw_only=True)
    label: str = field(default="", kw_only=True)
    inputs: Callable[[Mapping[str, Any], Mapping[str, Any]], Mapping[str, Any]] | None = None
    gains: Gains | None = None
    header_notes: Sequence[str] = ()
    sequences: Callable[[Any], Sequence[Any]] | None = None

    @cached_property
    def block(self) -> Block:
        """The Block, built at its first use; raises WiringError where it has another name."""
        block = self.make()
        if block.name != self.name:
            raise WiringError(f"the companion '{self.name}' makes a Block '{block.name}': give it the Block's name")
        return block

    def select_inputs(self, inputs: Mapping[str, Any], outputs: Mapping[str, Any]) -> dict[str, Any]:
        """Return the inputs (N,) by name for test vectors; `inputs` and `outputs` are those of the controller."""
        if self.inputs is not None:
            return dict(self.inputs(inputs, outputs))
        return {s.name: outputs[s.name] if s.name in outputs else inputs[s.name] for s in self.block.inputs}


@dataclass(frozen=True, eq=False)
class Drive:
    """Companions through which the controller drives a plant, one after another, such as the commutation of a motor.

    Each input of their Blocks is, by name, an output of an earlier Block or of the controller, or else an input of the
    controller. The outputs of the last Block are the inputs of `plant`, by name. It has the states, outputs and
    parameters of the stage's plant; experiments and fault campaigns run on it.
    """

    plant: Plant
    companions: tuple[Companion, ...]

    @property
    def blocks(self) -> tuple[Block, ...]:
        """The Blocks of the companions."""
        return tuple(c.block for c in self.companions)

    def call_order(self, controller: str) -> str:
        """Return the sentence of the headers on the order in which a sample calls the steps."""
        steps = [f"{name}_step" for name in (controller, *(c.name for c in self.companions))]
        return (
            f"In each sample, call {' and then '.join(steps)}: a step takes outputs of the steps before it, and the "
            "outputs of the last one go to the hardware."
        )
