"""What the command line computes of a declared stage: its C, its experiments, and the stimuli of its machine code.

The verification is in `synth.verify.standard`, the report in `synth.report.template`. A companion is a Block that is
emitted beside the controller, such as the commutation of a motor (`synth.declare.companion`).

Signs of the actuators: which coordinates a positive input accelerates, from the plant's input Jacobian df/du.

i_d1: +y -phi     the rates of y and phi change with i_d1 by a positive and a negative amount

An input without a slope at the point, such as a current of 0 A whose force grows with its square, has the signs of what
its upper end changes.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from synth.base.progress import Progress
from synth.block import Block
from synth.blocks.guard import safety
from synth.declare.companion import Companion
from synth.declare.stage import Stage
from synth.emit import pipeline, write
from synth.emit.c import manifest
from synth.emit.write import EmittedCode
from synth.errors import DesignError, EmitError
from synth.execute import host
from synth.fault import with_reactions
from synth.plant import Plant
from synth.simulate import experiments
from synth.simulate import rig as rigs
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.stage import tunable
from synth.verify import standard, stimuli
from synth.verify.steps import Steps

SMALL = 1e-6  # of the largest entry of a rate: a smaller one is none


def actuator_signs(plant: Plant, rates: Mapping[str, str], point: Mapping[str, float]) -> dict[str, str]:
    """Return by input of the plant the coordinates that it accelerates, with their signs, at a point of operation.

    `rates` names the state that is the rate of each coordinate; states and inputs that the point does not have are 0.
    """
    x, u = ca.SX.sym("x", len(plant.states)), ca.SX.sym("u", len(plant.inputs))
    f = ca.Function("f", [x, u], [plant.f(x, u, plant.values)])
    B = ca.Function("B", [x, u], [ca.jacobian(f(x, u), u)])
    at = [np.array([point.get(s.name, 0.0) for s in signals]) for signals in (plant.states, plant.inputs)]
    slopes = np.array(B(*at))
    for k, signal in enumerate(plant.inputs):
        if not slopes[:, k].any():
            upper = np.where(np.arange(len(at[1])) == k, signal.high, at[1])
            slopes[:, k] = np.asarray(f(at[0], upper) - f(*at)).ravel()
    names = [s.name for s in plant.states]
    entries = slopes[[names.index(rate) for rate in rates.values()]]
    entries[np.abs(entries) <= SMALL * np.abs(entries).max(axis=1, keepdims=True)] = 0
    texts = {
        s.name: " ".join(f"{'+' if v > 0 else '-'}{q}" for q, v in zip(rates, column, strict=True) if v)
        for s, column in zip(plant.inputs, entries.T, strict=True)
    }
    return {name: text for name, text in texts.items() if text}


def compiled_controller(stage: Stage, scalar: type[np.floating]) -> host.Controller:
    """Return the stage's controller in a scalar type, compiled once."""
    return _compile(stage, np.dtype(scalar).name)


@lru_cache(maxsize=8)
def _compile(stage: Stage, scalar: str) -> host.Controller:
    scalar_type = np.float32 if scalar == "float32" else np.float64
    block = _with_measured_safe_output(stage)  # as it is emitted: the passes over it have run
    return host.compile_block(block, scalar_type, error=stage.surrogate_error.get(scalar_type))


def rig(stage: Stage, scalar: type[np.floating]) -> Rig:
    """Return the stage's plant under its controller in a scalar type."""
    return rigs.of_stage(stage, compiled_controller(stage, scalar))


def rig_without_latch(stage: Stage, scalar: type[np.floating]) -> Rig:
    """Return the stage's plant under a controller that never latches.

    A fault campaign with it must fail; otherwise the campaign could not detect a latch that is missing.
    """
    block = safety.without_latch(stage.controller.block)
    return rigs.of_stage(stage, host.compile_block(block, scalar, error=stage.surrogate_error.get(scalar)))


def emit(stage: Stage, scalar: type[np.floating]) -> dict[str, EmittedCode]:
    """Return the files of the controller and its companions by folder, with test vectors of a closed loop."""
    error = stage.surrogate_error.get(scalar)  # allowed relative error of the approximations of functions
    gains_document = stage.gains(scalar) if stage.gains else gains(stage, scalar)
    block, notes = _with_measured_safe_output(stage), header_notes(stage)
    try:
        files = write.emit(
            block,
            scalar,
            {"design": gains_document},
            error=error,
            header_notes=notes,
            datasheet_notes=[*stage.datasheet_notes, *_bench(stage)],
            warning=stage.warning,
            latency=_latency(stage),
            gain_error=stage.gain_error,
        )
    except EmitError as refused:
        raise _on_bench(stage, scalar, refused) from refused
    controller = host.load(files.files, files.manifest)
    record_inputs = standard.stimuli_of(stage).vectors or record
    inputs = dict(record_inputs(rigs.of_stage(stage, controller)))
    replay = controller.replay(inputs)
    folders = {stage.name: _with_vectors(files, inputs, replay)}
    for companion in stage.companions:
        folders[companion.name] = _emit_companion(companion, stage, scalar, inputs, replay)
    return folders


def with_casadi_c(stage: Stage, folders: Mapping[str, EmittedCode]) -> dict[str, EmittedCode]:
    """Return emitted files by folder with CasADi's own C of each Block in place of the emitted .c."""
    blocks = {stage.name: tunable.with_bench(stage)} | {c.name: c.block for c in stage.companions}
    errors = {np.dtype(t).name: error for t, error in stage.surrogate_error.items()}
    return {n: write.with_casadi_c(e, blocks[n], errors.get(e.manifest["scalar"])) for n, e in folders.items()}


def header_notes(stage: Stage) -> list[str]:
    """Return the sentences of the header of the stage's controller."""
    return [*_call_order(stage), *_start(stage), *_signs(stage), *stage.header_notes]


def _emit_companion(
    companion: Companion,
    stage: Stage,
    scalar: type[np.floating],
    inputs: Mapping[str, NDArray[Any]],
    replay: host.Replay,
) -> EmittedCode:
    """Return the files of a companion; its test vectors follow from the inputs and the replay of the controller."""
    document = {"design": companion.gains(scalar)} if companion.gains else None
    drives = stage.drive is not None and companion in stage.drive.companions
    order, error = _call_order(stage) if drives else [], stage.surrogate_error.get(scalar)
    notes = [*order, *(companion.header_notes or stage.header_notes)]
    latency = _latency(stage) if drives else 0
    block, allowed = companion.block, stage.gain_error
    files = write.emit(block, scalar, document, error=error, header_notes=notes, latency=latency, gain_error=allowed)
    companion_inputs = companion.select_inputs(inputs, replay.outputs)
    companion_replay = host.load(files.files, files.manifest).replay(companion_inputs)
    return _with_vectors(files, companion_inputs, companion_replay)


def _bench(stage: Stage) -> list[str]:
    """Return which parameters the constants follow from that are tuned on the machine."""
    if stage.tuning is None or stage.tuning.bench is None:
        return []
    free = {f.name: f for f in stage.tuning.free}
    ranges = [
        f"{n} ({free[n].about}), {low:g} .. {high:g} {free[n].unit}"
        for n, (low, high) in stage.tuning.bench.ranges.items()
    ]
    return [f"Constants that are tuned on the machine follow from {'; '.join(ranges)}: `synth tune` computes them."]


def _on_bench(stage: Stage, scalar: type[np.floating], refused: EmitError) -> EmitError:
    """Return why a law is refused, with the largest ranges of its bench over which it is not."""

    def proves(block: Block) -> bool:
        try:
            pipeline.reduce(block.rounded(scalar), scalar, error=stage.surrogate_error.get(scalar))
        except EmitError:
            return False
        return True

    if not _bench(stage) or not proves(stage.controller.block):
        return refused
    ranges = [f"{n} within {low:.4g} .. {high:.4g}" for n, (low, high) in tunable.proved_ranges(stage, proves).items()]
    mend = f"declare {', '.join(ranges)}, over which it is proved" if ranges else "declare the law without a bench"
    return EmitError(f"over the ranges of the bench: {refused}; at the declared values it is proved: {mend}")


def _latency(stage: Stage) -> int:
    return stage.interface.delay if stage.interface.actuators else 0


def _start(stage: Stage) -> list[str]:
    """Return the state of the machine that init assumes, of a stage with actuators."""
    if not stage.interface.actuators:
        return []
    return ["At init the machine is at rest under the safe output, which acts until the first outputs of the step do."]


def _signs(stage: Stage) -> list[str]:
    """Return what a positive value of each actuator accelerates, of a stage with rates and points of operation."""
    if not stage.velocities or not stage.operating_points:
        return []
    actuators = {a.of: a.name for a in stage.interface.actuators}
    safe = {a.of: a.safe for a in stage.interface.actuators}
    signs = actuator_signs(stage.plant, stage.velocities, safe | dict(next(iter(stage.operating_points.values()))))
    texts = [f"{actuators[n]} {text}" for n, text in signs.items() if n in actuators]
    return [f"Signs of what a positive value accelerates, from the plant: {'; '.join(texts)}."]


def _call_order(stage: Stage) -> list[str]:
    return [stage.drive.call_order(stage.name)] if stage.drive else []


def _with_measured_safe_output(stage: Stage) -> Block:
    """Return the controller's Block, with the measured effect of the safe output appended to that declared."""
    block = tunable.with_bench(stage)
    block = replace(block, failures=with_reactions(block.failures, stage.reactions, stage.used_instead))
    if stage.safe_output is None or block.safety is None:
        return block
    effect = f"{block.safety.safe_output_effect}; {stage.safe_output.text()}"
    return replace(block, safety=replace(block.safety, safe_output_effect=effect))


def _with_vectors(files: EmittedCode, inputs: Mapping[str, NDArray[Any]], replay: host.Replay) -> EmittedCode:
    text = manifest.document(inputs, replay.outputs, replay.faults)
    return replace(files, files={**files.files, "vectors.json": text})


def record(rig: Rig) -> Mapping[str, NDArray[Any]]:
    """Return the measured inputs (VECTOR_STEPS,) of a closed loop with bad samples, of which the last ones latch.

    Raises DesignError for a loop that diverges beyond what its scalar type holds.
    """
    measured = stimuli.closed_loop(rig, stimuli.VECTOR_STEPS, stimuli.BAD_SAMPLE_EXCESS).measured
    for name, column in measured.items():
        if not np.isfinite(column).all():
            k = int(np.argmin(np.isfinite(column)))
            raise DesignError(
                f"the closed loop of '{rig.stage.name}' diverges: '{name}' is {column[k]:g} in sample {k}; check the "
                f"period of {rig.period_s:g} s, the signs and the gains"
            )
    return measured


def gains(stage: Stage, scalar: type[np.floating]) -> dict[str, Any]:
    """Return the document of gains.json: the plant with its parameters, the rate, and the gains of each law."""
    laws = {law.name: dict(law.gains(scalar)) for law in stage.controller.laws if law.gains}
    parameters = {p.name: {"value": p.value, "unit": p.unit, "tolerance": p.tolerance} for p in stage.plant.parameters}
    return {"plant": stage.plant.name, "period_s": stage.controller.time.period_s, "parameters": parameters, **laws}


def simulate(stage: Stage, progress: Progress) -> list[Experiment]:
    """Run the experiments with the emitted C; raise Incomplete as `experiments.run`."""
    if not stage.all_experiments:
        return []
    return experiments.run(rig(stage, stage.scalar), stage.all_experiments, progress)


def with_headroom(stage: Stage, run: Experiment) -> Experiment:
    """Return an experiment with a check that fails if a state of the control laws has reached its bound.

    A state that the stage lists as limited on purpose may reach it.
    """
    controller = compiled_controller(stage, np.float64)
    return experiments.with_headroom(run, controller, stage.limited, stage.interface.constant_inputs(stage.plant))


def replay_inputs(stage: Stage, controller: host.Controller) -> Mapping[str, Any]:
    """Return the inputs (N,) with which the machine code is replayed: a closed loop with faults."""
    hooks = standard.stimuli_of(stage)
    if hooks.replay:
        return hooks.replay(controller)
    return stimuli.closed_loop(rigs.of_stage(stage, controller), stimuli.REPLAY_STEPS).measured


def cost_sequences(stage: Stage, controller: host.Controller, progress: Progress) -> Sequence[Steps]:
    """Return the steps that look for the costliest one and reach every decision of the machine code."""
    hooks = standard.stimuli_of(stage)
    if hooks.sequences:
        return hooks.sequences(controller, progress)
    loop = rigs.of_stage(stage, controller)
    return stimuli.sequences(
        loop, [experiments.result(e, loop) for e in stage.all_experiments], progress, hooks.further(controller)
    )


def law_alone(stage: Stage) -> EmittedCode | None:
    """Return the C of the law without its fault handling, in single precision, where the stage names it."""
    if stage.law_alone is None:
        return None
    error = stage.surrogate_error.get(np.float32)
    return write.emit(stage.law_alone.block, np.float32, error=error, gain_error=stage.gain_error)
