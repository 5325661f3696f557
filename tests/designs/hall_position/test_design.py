"""The design as the workspace finds it: what it ships, measures and reports, and the proofs of its committed C."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs.hall_position import config, stimuli
from designs.hall_position.glsdc import estimator
from designs.hall_position.protected import config as protected
from synth.app import workspace
from synth.base import contents
from synth.check import Check
from synth.declare.stage import Stage
from synth.emit import write
from synth.verify import standard
from synth.verify.proofs import contract, eva, prove
from tests import tools

ROOT = Path(__file__).parents[3]
GENERATED = ROOT / "generated_c"
needs_provers = tools.needs(*tools.PROVERS, shows="that the committed C keeps its contract for every input")


@pytest.fixture(scope="module")
def design() -> Stage:
    (hall_position,) = workspace.designs(ROOT, ["hall_position"])
    return hall_position


def committed_files(name: str) -> tuple[dict[str, str], dict[str, Any]]:
    folder = GENERATED / name
    return {p.name: p.read_text() for p in folder.glob("*.[ch]")}, json.loads((folder / "manifest.json").read_text())


def test_the_workspace_finds_it(design: Stage) -> None:
    assert (design.name, design.scalar) == (config.NAME, np.float32)
    block = design.controller.block
    assert block.name == design.name and block.time == config.TIME and block.time.period_s == 1 / 800
    assert [s.name for s in block.inputs] == ["V_ax", "V_ay", "V_bx", "V_by"]
    declared = standard.stimuli_of(design)
    assert (declared.replay, declared.sequences) == (stimuli.replay, stimuli.sequences)


def test_what_is_declared_is_the_guarded_estimator(design: Stage) -> None:
    """Byte by byte what a guard and the estimator are together; once latched its states go on."""
    other = estimator.guarded_estimator(config.array(), config.TIME, config.TUNING)
    texts = [write.emit(block, np.float32, libm=True).files for block in (design.controller.block, other)]
    assert texts[0] == texts[1]


def test_every_task_has_a_key(design: Stage) -> None:
    """So that evidence and reports are made once."""
    for task in (design, design.verify, design.audit, design.contents):
        assert contents.digest(task) == contents.digest(task)


@pytest.mark.parametrize(("name", "sensors"), [(config.NAME, 2), (protected.THREE, 3), (protected.NAME, 4)])
def test_its_manifest_says_when_it_latches(name: str, sensors: int) -> None:
    _, manifest = committed_files(name)
    assert manifest["safety"]["bad_samples"] == 5 and manifest["safety"]["safe_output"] == {}
    assert manifest["design"] == name and manifest["period_s"] == 1 / 800
    latched = [f for f in manifest["faults"] if f.get("latched")]
    assert len(manifest["faults"]) == 2 * sensors + 1 and [f["bit"] for f in latched] == [31]


def test_two_sensors_are_without_fault_protection_in_the_first_line() -> None:
    """In header and manifest, with the fields for which the deviations hold; more sensors have no such line."""
    words, fields = "two sensors have no fault protection", "hold for the field of the model only"
    first_lines = {
        (name, file): (GENERATED / name / file).read_text().splitlines()[0]
        for name in (config.NAME, *protected.PLACES)
        for file in (f"{name}.h", "manifest.json")
    }
    assert {name for (name, _), line in first_lines.items() if words in line} == {config.NAME}
    assert all(words in line for (name, _), line in first_lines.items() if name == config.NAME)
    _, manifest = committed_files(config.NAME)
    header = (GENERATED / config.NAME / f"{config.NAME}.h").read_text().replace("\n * ", " ")
    for text in (header, manifest["warning"]):
        assert fields in text and "fabricated" in text


@pytest.mark.parametrize(("name", "degrees"), [(config.NAME, 2.4), (protected.THREE, 9), (protected.NAME, 9)])
def test_every_header_says_where_the_body_is_at_init(name: str, degrees: float) -> None:
    header = (GENERATED / name / f"{name}.h").read_text().replace("\n * ", " ")
    assert "within half a pitch of the counted origin" in header and f"within {degrees:g} degrees of yaw 0" in header
    assert ("rests until the first valid sample" in header) == (name != config.NAME)


def test_the_header_of_two_sensors_asks_for_the_motion_of_the_experiment() -> None:
    header, of = (GENERATED / config.NAME / f"{config.NAME}.h").read_text().replace("\n * ", " "), config.COLD_START
    motion = f"radius of {1e3 * of.radius:g} mm at {1e3 * of.slowest:g} to {1e3 * of.fastest:g} mm/s"
    assert motion in header and f"At least {100 * of.valid:g} % of starts are valid within one revolution" in header


def failed_names(checks: tuple[Check, ...]) -> list[str]:
    return [c.name for c in checks if not c.passed]


@needs_provers
def test_the_committed_c_keeps_its_contract_over_the_whole_domain() -> None:
    files, manifest = committed_files(config.NAME)
    proof = eva.prove(files, manifest)
    assert proof.proved == proof.claims > 100 and failed_names(proof.checks()) == []
    assert failed_names(contract.compare(files, manifest).checks()) == []
    assert failed_names(prove.inspect(files).checks()) == []


@needs_provers
def test_a_state_beyond_its_bounds_is_detected() -> None:
    """The planted defect."""
    files, manifest = committed_files(config.NAME)
    name, state = f"{config.NAME}.c", "state->motion_x = "
    text, count = re.subn(rf"{state}[^;]+;", f"{state}2.0f;", files[name])
    assert count == 1
    proof = eva.prove({**files, name: text}, manifest)
    assert [claim for claim in proof.unproved if "motion_x" in claim] and failed_names(proof.checks())


@needs_provers
def test_a_number_that_is_none_and_passes_is_detected() -> None:
    files, manifest = committed_files(config.NAME)
    name = f"{config.NAME}.c"
    deaf = files[name].replace("if (fabsf(value) <= high) {", "if (!(fabsf(value) > high)) {")
    assert deaf != files[name] and failed_names(contract.compare({**files, name: deaf}, manifest).checks())


def test_its_audit_is_that_of_the_paper(design: Stage) -> None:
    assert next(iter(design.audit(design))).id.startswith("K-")
