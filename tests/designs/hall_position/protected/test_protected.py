"""Three and four sensors: the committed C, its witnesses with planted defects, and its cost."""

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from designs.hall_position import verification_protected as verification
from designs.hall_position.protected import config
from models import hall_motions as motions
from models.hall_motions import Numbers, Pose
from synth.execute import host, target
from synth.verify.suite import Witnesses
from tests import ceilings, tools

GENERATED = Path(__file__).parents[4] / "generated_c"


def committed(name: str = config.NAME) -> tuple[dict[str, str], dict[str, object]]:
    folder = GENERATED / name
    files = {p.name: p.read_text() for p in folder.glob("*.[ch]")}
    return files, json.loads((folder / "manifest.json").read_text())


@cache
def sound(name: str = config.NAME) -> Witnesses:
    return verification.witnesses(name)


@pytest.mark.whole
@pytest.mark.parametrize("name", config.PLACES)
def test_all_witnesses_agree(name: str) -> None:
    agreements, checks = verification.compare(sound(name), 6, lambda _: None)
    assert {a.first for a in agreements} == {"reference", "casadi", "casadi_c"}
    assert [c.name for c in checks if not c.passed] == []


def travel(V: Numbers) -> dict[str, Numbers]:
    return dict(host.load(*committed()).replay(motions.by_input(V)).outputs)


def test_pitches_are_counted_in_motion_and_no_further_than_declared() -> None:
    n, rest = 3000, 120
    X = np.concatenate([np.zeros(rest), 0.55 * np.sin(np.linspace(0, np.pi, n - rest))])  # beyond 8 pitches, and back
    out = travel(motions.noisy(config.array(), Pose(X, 0 * X, 0 * X), 3))
    inside = (np.arange(n) > rest) & (config.array().pitch * 8 > X) & (np.arange(n) < np.argmax(X))
    assert out["valid"][inside].mean() > 0.95 and np.abs(out["X"] - X)[inside & (out["valid"] > 0)].max() < 5e-4
    assert not out["valid"][np.argmax(X) :].any()


@pytest.mark.slow
@tools.needs_arm_gcc
@pytest.mark.parametrize("name", config.PLACES)
def test_its_cost_is_known(name: str) -> None:
    """The limit of four sensors with protection levels; three take less."""
    ceiling = ceilings.of(config.NAME, ceilings.BUILDS[ceilings.O2])
    files, manifest = committed(name)
    vectors = config.vectors({"V_ax": np.zeros(1, np.float32)}, {}, name)
    run = target.load(files, manifest, compiler="gcc").measure({n: v[:600] for n, v in vectors.items()})
    assert int(run.cost.instructions.max()) <= ceiling
    assert host.load(files, manifest).period_s == 1 / 800
