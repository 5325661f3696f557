"""Standard tasks of a declared stage, which the command line runs unless the design replaces them.

emit       C, manifest, gains and test vectors        verify        evidence of all witnesses
simulate   the experiments, with the emitted C        cost_stimuli  stimuli of the machine code
report     the standard report
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.block import Block
from synth.blocks import safety
from synth.declaration import Stage
from synth.emit import write
from synth.emit.c import vectors
from synth.emit.write import EmittedCode
from synth.execute import build, host
from synth.progress import Progress
from synth.report.audit import Row
from synth.simulate import experiments, headroom
from synth.simulate import rig as rigs
from synth.simulate.experiment import Experiment
from synth.simulate.rig import Rig
from synth.verify import agree, stimuli
from synth.verify.cost import Cost
from synth.verify.evidence import Evidence
from synth.verify.steps import Steps
from synth.workspace import CostStimuli


def compiled_controller(stage: Stage, scalar: type[np.floating]) -> host.Controller:
    """Return the stage's controller in a scalar type, compiled once."""
    return _compile(stage, np.dtype(scalar).name)


@lru_cache(maxsize=8)
def _compile(stage: Stage, scalar: str) -> host.Controller:
    kind = np.float32 if scalar == "float32" else np.float64
    return build.compile_block(stage.controller.block, kind, error=stage.surrogate_error.get(kind))


def rig(stage: Stage, scalar: type[np.floating]) -> Rig:
    """Return the stage's plant under its controller in a scalar type."""
    return rigs.of_stage(stage, compiled_controller(stage, scalar))


def rig_without_latch(stage: Stage, scalar: type[np.floating]) -> Rig:
    """Return the stage's plant under a controller that never latches, the negative control of a fault campaign."""
    block = safety.without_latch(stage.controller.block)
    return rigs.of_stage(stage, build.compile_block(block, scalar, error=stage.surrogate_error.get(scalar)))


def emit(stage: Stage, scalar: type[np.floating]) -> dict[str, EmittedCode]:
    """Return the files of the controller and its companions by folder, with test vectors of a closed loop."""
    error, block = stage.surrogate_error.get(scalar), _with_measured_safe_output(stage)
    files = write.emit(block, scalar, {"design": (stage.gains or partial(gains, stage))(scalar)}, error=error)
    controller = host.load(files.files, files.manifest)
    inputs = dict((stage.recording or record)(rigs.of_stage(stage, controller)))
    replay = controller.replay(inputs)
    folders = {stage.name: _with_vectors(files, inputs, replay)}
    for companion in stage.companions:
        document = {"design": companion.gains(scalar)} if companion.gains else None
        companion_files = write.emit(companion.block, scalar, document, error=error)
        recorded = companion.select_inputs(inputs, replay.outputs)
        companion_outputs = host.load(companion_files.files, companion_files.manifest).replay(recorded)
        folders[companion.block.name] = _with_vectors(companion_files, recorded, companion_outputs)
    return folders


def _with_measured_safe_output(stage: Stage) -> Block:
    """Return the controller's Block; its reason for the safe output goes on with what was measured."""
    block = stage.controller.block
    if stage.safe_output is None or block.safety is None:
        return block
    reason = f"{block.safety.reason}; {stage.safe_output.text()}"
    return replace(block, safety=replace(block.safety, reason=reason))


def _with_vectors(files: EmittedCode, inputs: Mapping[str, NDArray[Any]], replay: host.Replay) -> EmittedCode:
    text = vectors.document(inputs, replay.outputs, replay.faults)
    return replace(files, files={**files.files, "vectors.json": text})


def record(rig: Rig) -> Mapping[str, NDArray[Any]]:
    """Return the inputs (1000,) of a closed loop with bad samples, up to the latch."""
    return stimuli.closed_loop(rig, stimuli.VECTORS, stimuli.BEYOND).measured


def gains(stage: Stage, scalar: type[np.floating]) -> dict[str, Any]:
    """Return the document of gains.json: the plant with its parameters, the rate, and the gains of each law."""
    laws = {law.name: dict(law.gains(scalar)) for law in stage.controller.laws if law.gains}
    parameters = {p.name: {"value": p.value, "unit": p.unit, "tolerance": p.tolerance} for p in stage.plant.parameters}
    return {"plant": stage.plant.name, "period_s": stage.controller.time.period_s, "parameters": parameters, **laws}


def simulate(stage: Stage, progress: Progress) -> list[Experiment]:
    """Run the experiments with the emitted C; a check of each fails where a state of the laws reached its bound."""
    single, double = rig(stage, stage.scalar), compiled_controller(stage, np.float64)
    runs = experiments.run(single, stage.experiments, progress)
    return [headroom.with_headroom(run, double, stage.limited) for run in runs]


def no_audit(stage: Stage) -> Iterator[Row]:
    """Yield nothing: only a published stage has published values."""
    return iter(())


def _no_steps(controller: host.Controller) -> Sequence[Steps]:
    return ()


def cost_stimuli(
    stage: Stage, further_steps: Callable[[host.Controller], Sequence[Steps]] = _no_steps, floor: agree.Floor = None
) -> CostStimuli:
    """Return the stimuli of the machine code; `further_steps` returns steps that are special to this stage."""

    def replay(controller: host.Controller) -> Mapping[str, NDArray[Any]]:
        return stimuli.closed_loop(rigs.of_stage(stage, controller), stimuli.REPLAY).measured

    def sequences(controller: host.Controller, progress: Progress) -> Sequence[Steps]:
        loop = rigs.of_stage(stage, controller)
        return stimuli.sequences(loop, [e.run(loop) for e in stage.experiments], progress, further_steps(controller))

    return CostStimuli(lambda: stage.controller.block, replay, sequences, floor)


def report(
    stage: Stage,
    files: Mapping[str, EmittedCode],
    evidence: Evidence,
    runs: Sequence[Experiment],
    rows: Sequence[Row],
    cost: Cost | None,
) -> str:
    """Return the report as one HTML document."""
    from synth.report import template  # matplotlib takes longer to import than all else together

    return template.report(stage, files, evidence, runs, rows, cost)
