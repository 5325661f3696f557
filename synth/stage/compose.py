"""From the declaration of a stage to its controller and design.

    interface    names, units and ranges from the plant's signals; guard, errors, limits and safe output follow
    controller   guard + errors + laws + limits + safe output, composed into one Block
    design       the tasks that the command line runs for a stage

Laws are Blocks. They read ``<name>_held`` of sensors and set-points, ``<sensor>_error``, ``<actuator>_excess``,
``<actuator>_before``, ``ready``, ``complete`` and ``latched``. Their outputs are ``<actuator>_demand``, which is
limited here, or ``<actuator>_computed``.
"""

import dataclasses
from collections.abc import Callable, Sequence
from typing import Any

from synth.block import Block, Exprs, Step, build, clip
from synth.blocks.guard import missed_calls as calls
from synth.blocks.guard import safe_output, safety
from synth.composition import compose
from synth.declare.stage import (
    Composition,
    Controller,
    Interface,
    Law,
    Stage,
    Synthesis,
)
from synth.errors import DesignError, SignalError
from synth.plant import Plant, velocities
from synth.signals import Signal, signal_names
from synth.stage import consistency
from synth.stage.interfaces import guarded_inputs, safe
from synth.timing import Discrete


def errors(time: Discrete, interface: Interface, of: Sequence[str]) -> Block:
    """Return the Block of the tracking errors, set-point minus measurement: ``<sensor>_error``."""
    points = {sensor: s for sensor, s in interface.set_point_of.items() if sensor in of}
    held = [interface.held(name) for sensor, s in points.items() for name in (sensor, s.name)]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({f"{n}_error": u[f"{s.name}_held"] - u[f"{n}_held"] for n, s in points.items()})

    return build(
        "errors", time, law, inputs=held, outputs=[interface.error(of) for of in points], tag="tracking errors"
    )


def limits(time: Discrete, interface: Interface, demands: Sequence[Signal]) -> Block:
    """Return the Block that limits ``<name>_demand`` to ``<name>_computed``; ``<name>_excess`` is the difference."""
    ends = {s.name.removesuffix("_demand"): s for s in demands}

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        limited = {n: clip(u[s.name], interface.signals[n]) for n, s in ends.items()}
        excess = {f"{n}_excess": limited[n] - u[s.name] for n, s in ends.items()}
        return Step({f"{n}_computed": v for n, v in limited.items()} | excess)

    outputs = [*(interface.computed_output(n) for n in ends), *(interface.excess(n) for n in ends)]
    return build("limits", time, law, inputs=list(demands), outputs=outputs, tag="actuator limits")


Laws = Sequence[Law | Synthesis | Block]


def controller(
    name: str,
    time: Discrete,
    interface: Interface,
    laws: Laws | Callable[[], Laws],
    outputs: Sequence[str] | None = None,
) -> Controller:
    """Compose guard, errors, laws, limits and safe output; after a latch the states of the laws are frozen.

    A law that drives ``<sensor>_held`` of some sensors replaces readings: it reads ``<sensor>_accepted`` of the guard,
    and drives ``sufficient`` and ``landed`` as well (`blocks.redundancy`, `blocks.landing`).

    The controller is composed at its first use, which also calls `laws` where they are a function. `outputs` are by
    default those of the actuators. A law that reads the value of an actuator comes after the safe output and may pass
    it on to several outputs. Without actuators the outputs are those of the laws, which continue after a latch.

    The first use raises WiringError as `composition.compose`, SignalError as `safety.guard` and `safe_output.block`,
    for an output that a law computes from values of actuators, whose safe value nobody has declared, and for an
    actuator that no output passes on.
    """

    def compose_laws() -> Composition:
        return _composition(name, time, interface, laws() if callable(laws) else laws, outputs)

    return Controller(name, time, interface, compose_laws)


def _composition(
    name: str, time: Discrete, interface: Interface, laws: Laws, outputs: Sequence[str] | None
) -> Composition:
    resolved = tuple(_law(law, time, interface) for law in laws)
    blocks = [block for law in resolved for block in law.blocks]
    read = {s.name for block in blocks for s in block.inputs}
    driven = {s.name: s for block in blocks for s in block.outputs}
    demands = [driven[f"{a.name}_demand"] for a in interface.actuators if f"{a.name}_demand" in driven]
    controlled = [n for n in interface.set_point_of if f"{n}_error" in read - set(driven)]
    actuators = [a.name for a in interface.actuators]
    behind = [block for block in blocks if {*actuators} & {s.name for s in block.inputs}]
    unread = [n for n in actuators if f"{n}_before" not in read]
    replaced = {f"{s.name}_held": f"{s.name}_accepted" for s in interface.sensors if f"{s.name}_held" in driven}
    i, inputs = interface, guarded_inputs(interface)
    guard = safety.guard(
        time, inputs, i.bad_samples, i.suspected, i.safe_output_effect, bool(replaced), i.braking, i.good_samples
    )
    parts = (
        guard.renamed(replaced),
        *([errors(time, interface, controlled)] if controlled else []),
        *(block for block in blocks if block not in behind),
        *([limits(time, interface, demands)] if demands else []),
        *([safe_output.block(time, interface.outputs, safe(interface), unread)] if interface.actuators else []),
        *behind,
    )
    if interface.missed_calls:
        parts += (calls.block(time, interface.missed_calls, _free_bit(parts)),)
    driven_outputs = list(actuators) or [s.name for block in blocks for s in block.outputs]
    block = compose(
        name, parts, inputs=signal_names(interface.inputs), outputs=driven_outputs if outputs is None else list(outputs)
    )
    if interface.actuators:
        _require_safe_values(block, interface, blocks)
    return Composition(resolved, parts, safety.frozen(block) if interface.actuators else block)


def _require_safe_values(block: Block, interface: Interface, laws: Sequence[Block]) -> None:
    """Raise SignalError for an output computed from actuators without a safe value, and for an actuator without output.

    `laws` are the Blocks of the laws, of which some come behind the safe output.
    """
    assert block.safety is not None
    outputs = signal_names(block.outputs)
    origins = {a.name: ([a.name], "") for a in interface.actuators}  # actuators and last Block by signal
    for _ in laws:
        for part in laws:
            read = dict.fromkeys(a for s in part.inputs for a in origins.get(s.name, ([], ""))[0])
            origins |= {s.name: ([*read], part.name) for s in part.outputs if read and s.name not in origins}
    if unsafe := [n for n in outputs if n in origins and n not in block.safety.safe_output]:
        actuators, part_name = origins[unsafe[0]]
        raise SignalError(
            f"output '{unsafe[0]}' of '{block.name}' has no safe value: the Block '{part_name}' computes it from "
            f"{', '.join(actuators)} behind the safe output; declare '{unsafe[0]}' as the actuator, with safe and "
            f"slew_per_s, and let the Block give '{unsafe[0]}_demand' from demands"
        )
    reached = {a for n in outputs for a in origins.get(n, ([], ""))[0]}
    if idle := [a.name for a in interface.actuators if a.name not in reached]:
        raise SignalError(
            f"actuator '{idle[0]}' of '{block.name}' reaches none of the outputs {', '.join(outputs)}, so its safe "
            f"value has no effect: add '{idle[0]}' to `outputs`, or leave `outputs` out"
        )


def _free_bit(blocks: Sequence[Block]) -> int:
    """Return the lowest bit of the fault word that no Block sets, or the latch bit if there is none."""
    used = {f.bit for block in blocks for f in block.faults}
    return min({*range(safety.LATCH_BIT)} - used, default=safety.LATCH_BIT)


def _law(law: Law | Synthesis | Block, time: Discrete, interface: Interface) -> Law:
    if isinstance(law, Block):
        return Law(law.name, (law,))
    return law if isinstance(law, Law) else law.law(time, interface)


def design(controller: Controller, plant: Plant, **fields: Any) -> Stage:
    """Return a stage with its controller and plant; `fields` are further ones of `declare.stage.Stage`.

    The rates of positions with stops follow from the plant where `velocities` leave them out.

    Raises DesignError for an unknown field, and for a stage without `reference`; SignalError and DesignError for what
    does not fit together, as `consistency.require_consistent`.
    """
    known = [f.name for f in dataclasses.fields(Stage) if f.name not in ("controller", "plant")]
    if unknown := [name for name in fields if name not in known]:
        raise DesignError(f"a stage has no field '{unknown[0]}': give some of {', '.join(known)}")
    stage = Stage(controller, plant, **fields)
    if {*stage.stops} - {*stage.velocities}:
        rates = velocities(plant)
        stage = dataclasses.replace(
            stage, velocities={q: rates[q] for q in stage.stops if q in rates} | dict(stage.velocities)
        )
    consistency.require_consistent(stage)
    return stage
