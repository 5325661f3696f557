"""What every design keeps: the committed C is that of the declaration, compiles, answers its vectors, and planted
defects are found; header, manifest, gains and vectors tell the same.
"""

import json
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from synth.app import standard_tasks, workspace
from synth.block import Constant
from synth.declare.stage import Stage
from synth.emit.write import EmittedCode
from synth.execute import compile as host_compiler
from synth.execute import host
from synth.report import standard
from synth.testing import test_the_evidence_passes as passes
from synth.testing import undetected_defects
from synth.verify import agree, sampling
from tests import tools

ROOT = Path(__file__).parents[2]
DESIGNS = {design.name: design for design in workspace.designs(ROOT)}
FILES = sorted(folder.name for folder in (ROOT / "generated_c").iterdir() if (folder / "vectors.json").exists())
LAST_BITS = 8  # units in the last place of double precision by which libm's functions may differ
SINE = 2e-5  # of an output of a C that calls sines: C libraries differ in the last place
STANDARD = [name for name in DESIGNS if not name.startswith("planar_6dof")]
CALLS_SINES = ("maglev_5dof", "maglev_5dof_precise", "maglev_5dof_phase")


@pytest.fixture(scope="module", params=DESIGNS)
def design(request: pytest.FixtureRequest) -> Stage:
    return DESIGNS[request.param]


@cache
def emitted(name: str, double: bool) -> Mapping[str, EmittedCode]:
    return standard_tasks.emit(DESIGNS[name], np.float64 if double else np.float32)


@cache
def committed(name: str) -> tuple[dict[str, str], dict[str, Any], dict[str, Any], dict[str, Any]]:
    """Return C, manifest, vectors and gains of a folder of generated_c/."""
    folder = ROOT / "generated_c" / name
    documents = (json.loads((folder / f"{kind}.json").read_text()) for kind in ("manifest", "vectors", "gains"))
    return {p.name: p.read_text() for p in folder.glob("*.[ch]")}, *documents  # type: ignore[return-value]


def test_the_committed_files_are_regenerated_byte_for_byte(design: Stage) -> None:
    for name, made in emitted(design.name, False).items():
        folder = ROOT / "generated_c" / name
        fresh = {file: text for file, text in made.files.items() if file != "vectors.json"}
        stale = f"generated_c/{name} is stale: run `synth emit {design.name} --out generated_c` and commit"
        assert {file: (folder / file).read_text() for file in fresh} == fresh, stale
        assert {p.name for p in folder.iterdir()} == {*fresh, "vectors.json"}


@pytest.mark.parametrize("compiler", tools.HOST_COMPILERS)
@pytest.mark.parametrize("double", [False, True])
def test_the_c_compiles_without_a_warning(design: Stage, double: bool, compiler: str) -> None:
    for made in emitted(design.name, double).values():
        host_compiler.check(host.code(made.files), compiler=tools.host_compiler(compiler))


@pytest.mark.parametrize("name", FILES)
def test_the_committed_c_answers_its_vectors(name: str) -> None:
    """To the last bit, where it calls nothing of libm but roots: without contraction no compiler has a choice."""
    files, manifest, recorded, _ = committed(name)
    replay = host.load(files, manifest).replay({n: np.array(v) for n, v in recorded["inputs"].items()})
    assert replay.faults.tolist() == recorded["faults"]
    tolerance = SINE if name in CALLS_SINES else 0.0
    for signal, values in recorded["outputs"].items():
        np.testing.assert_allclose(replay.outputs[signal], np.array(values, np.float32), rtol=0, atol=tolerance)
        assert (np.abs(replay.outputs[signal] - np.roll(values, 1)) > tolerance).any() or not np.ptp(values)


@pytest.mark.parametrize("name", FILES)
def test_gains_are_shipped_as_they_are_rounded(name: str) -> None:
    constants = committed(name)[3]["constants"]
    assert all(c["value"] == float(np.float32(c["value"])) for c in constants.values())


def test_no_constant_is_near_where_rounding_turns(design: Stage) -> None:
    """What libm leaves of a constant in its last bits cannot change the single-precision number that is committed."""

    def turns(c: Constant) -> bool:
        ends = c.value + np.array([-1, 1]) * LAST_BITS * np.spacing(abs(c.value))
        return len(set(ends.astype(np.float32))) > 1

    block = design.controller.block
    assert [c.name for c in block.constants if turns(c)] == []
    assert sorted(committed(block.name)[3]["constants"]) == sorted(c.name for c in block.constants)


@pytest.mark.parametrize("name", STANDARD)
def test_defects_that_are_planted_are_found(name: str) -> None:
    """Those of the planar designs, whose guard is composed by hand, are in `planar_6dof.test_planted_defects`."""
    assert undetected_defects(DESIGNS[name]) == []


@pytest.mark.parametrize("name", ["levitator_2dof", "maglev_5dof_precise"])
def test_the_evidence_passes(name: str) -> None:
    """That of the other designs has tests of its own beside them, of what is drawn and recorded for it."""
    passes(DESIGNS[name])


def test_the_equations_of_the_law_are_shown(design: Stage) -> None:
    """The section checks each equation against the Block, and fails for a signal without a value."""
    assert standard.law(design.controller.block).title == standard.LAW


@pytest.mark.parametrize("name", [name for name in DESIGNS if name != "hall_position"])  # an estimator goes on
def test_once_latched_only_the_guard_and_the_safe_output_move(name: str) -> None:
    n, block, rng = 300, DESIGNS[name].controller.block, np.random.default_rng(6)
    states, inputs = sampling.anywhere(block, rng, n)
    states |= {"guard_latched": np.arange(n) % 2.0, "guard_ready": np.ones(n)}
    after, latched = agree.casadi(block)(states, inputs).states, np.arange(n) % 2 == 1
    loops = [s for s in states if not s.startswith(("guard_", "safe_output_"))]
    assert loops and all((after[s][latched] == states[s][latched]).all() for s in loops)
    assert np.mean([(after[s][~latched] != states[s][~latched]).any() for s in loops]) > 0.5
