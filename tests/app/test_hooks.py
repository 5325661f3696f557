"""A stage of a workspace outside the repository that uses every hook of the standard, built as `synth build` does."""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.app import builds, standard_tasks
from synth.base.progress import silent
from synth.block import Block, Exprs, Step, build
from synth.check import Check
from synth.declare.companion import Companion
from synth.declare.experiments import Run
from synth.declare.fault_campaign import FaultCampaign
from synth.declare.stage import Stage
from synth.report.audit import Printed, Published, Row, Verdict
from synth.report.page import Section, Text
from synth.report.template import Extra, Results
from synth.signals import Signal
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import Trajectory
from synth.verify import sampling, standard, steps
from synth.verify.standard import Stimuli
from tests import levitator

pytestmark = pytest.mark.slow

PID = levitator.design()
SHORT = FaultCampaign(period_s=0.2, settle_s=0.1, watch_s=0.2, onsets=1)
CALLS: list[str] = []


def drift(rig: Rig, name: str) -> Experiment:
    run = rig.run(0.05, {"z": 1e-4})
    return Experiment(name, "z drifts", "", run, ("z",), checks=(Check("reach", 1e-4, 2e-4, "m"),))


def random_steps(block: Block, n: int) -> tuple[sampling.Columns, sampling.Columns]:
    CALLS.append("random")
    return sampling.anywhere(block, np.random.default_rng(3), n // 100, sampling.MARGIN)


def edge_steps(block: Block, n: int) -> tuple[sampling.Columns, sampling.Columns]:
    CALLS.append("edge")
    return sampling.edge_steps(block, np.random.default_rng(4), n // 100)


def recorded(rig: Rig, whole: bool) -> dict[str, Trajectory]:
    assert not whole
    return {"replay of a fall": rig.run(0.05, {"z": 3e-4})}


def vectors(rig: Rig) -> dict[str, Any]:
    return dict(rig.run(0.1, {"z": 2e-4}).measured)


def further(controller: Any) -> list[steps.Steps]:
    CALLS.append("further")
    return [steps.random_steps(controller, 50)]


def stimuli() -> Stimuli:
    return Stimuli(
        seed=7,
        random=random_steps,
        random_checks=lambda states, results: [Check("random share", 0.1, 0.5, "1")],
        edge=edge_steps,
        runs=recorded,
        path_checks=lambda double, single: [Check("paths", 0.0, 1.0, "m")],
        vectors=vectors,
        further=further,
        floor=1.0,
        edge_floor=1.0,
        unit="A",
        counts={"pid_z_v": 1e-3},
        authority={"pid_z_integral": 1.0},
    )


def audit(of: Stage) -> Iterator[Row]:
    published = Published("P-1", "P", "p. 1", "1.0", {"value": Printed("1.0", "1")})
    yield Row(published, (), Verdict.REPRODUCES, "")


def contents(of: Stage, results: Results) -> Extra:
    return Extra(sections=(Section("Bench", (Text(f"{len(results.runs)} runs on granite"),)),))


def lamp() -> Block:
    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"light": ca.if_else(u["i1"] > 0, 0.5, 0.0)})

    inputs, outputs = [Signal("i1", "A", -3, 3, "current")], [Signal("light", "1", 0, 1, "on while a current flows")]
    return build("lamp", PID.TIME, law, inputs=inputs, outputs=outputs, tag="lamp")


def lamp_reference(x: Any, u: Any) -> tuple[dict[str, Any], dict[str, Any], Any]:
    return {}, {"light": np.where(np.asarray(u["i1"]) > 0, 0.5, 0.0)}, np.zeros(np.shape(u["i1"]), np.uint32)


HOOKED = replace(
    PID.DESIGN,
    scalar=np.float64,  # whose cost is not measured
    experiments=(),
    runs=lambda: [Run("drift", drift)],
    stimuli=stimuli,
    audit=audit,
    contents=contents,
    gains=lambda scalar: {"named": {"K": [1.0]}},
    companions=[Companion("lamp", lamp, reference=lamp_reference, label="the lamp")],
    tolerances=(),
    operating_points={"mid": {"z": 0.0}},
    faults=SHORT,
    require={},
)


def test_every_hook_reaches_the_evidence_the_report_and_the_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))
    built = builds.build(HOOKED).result(silent)
    names = {c.name for c in built.checks}
    expected = {"random share", "paths", "replay of a fall: casadi against c64", "reach"}
    expected |= {
        "random steps: next states of the law of reference and c64",
        "the lamp, edge steps: casadi against c64",
    }
    assert expected <= names and {"random", "edge"} <= set(CALLS)
    assert not [c for c in built.checks if not c.passed and "yield" not in c.name]
    assert "1 runs on granite" in built.page and "P-1" in built.page
    files = standard_tasks.emit(HOOKED, np.float64)
    assert set(files) == {HOOKED.name, "lamp"} and '"K": [' in files[HOOKED.name].files["gains.json"]
    assert '"samples": 200' in files[HOOKED.name].files["vectors.json"] or "vectors.json" in files["lamp"].files
    controller = standard_tasks.compiled_controller(HOOKED, np.float64)
    assert "random states and inputs" in {s.name for s in standard.stimuli_of(HOOKED).further(controller)}


def test_a_wrong_reference_of_a_part_and_a_missed_check_fail(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted: a lamp with another gain, and a check of the random steps above its limit."""
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path / "cache"))

    def brighter(x: Any, u: Any) -> tuple[dict[str, Any], dict[str, Any], Any]:
        lights = lamp_reference(x, u)
        return {}, {"light": 1.001 * lights[1]["light"]}, lights[2]

    def missed() -> Stimuli:
        return replace(stimuli(), random_checks=lambda states, results: [Check("random share", 0.9, 0.5, "1")])

    planted = replace(HOOKED, stimuli=missed, companions=[Companion("lamp", lamp, reference=brighter)])
    failed = {c.name for c in standard.verify(planted, silent, False).checks if not c.passed}
    assert "random share" in failed and "lamp, random steps: reference against c64" in failed
