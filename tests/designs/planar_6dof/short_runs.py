"""Runs as the designs' experiments are called, cut short, and reports made of few points."""

from dataclasses import replace

import numpy as np
import pytest

from designs.planar_6dof import drawings, experiments, page
from designs.planar_6dof.loop import simulate
from designs.planar_6dof.sensing import maps as sensing_maps
from synth.report.audit import Figure, Published, Row, Verdict
from synth.simulate.experiments import Experiment
from synth.simulate.rig import Rig
from synth.simulate.scenario import sample_times

MOST = 3e6  # bytes of a page
PRINTED = Published("Y-9", "Y", "section 5.2", "steps rise in less than 25 ms", {})
ROWS = [Row(PRINTED, (Figure("rise", 19.0, "ms"),), Verdict.REPRODUCES, "it does")]


def runs(loop: Rig) -> list[Experiment]:
    """Return a step, the same as over a finite matrix, an arc and a standstill."""
    step = experiments.step_experiment(loop, experiments.step(loop, "x", 20e-6, 0.1), "step_x", "x by 20 um", None)
    rest = Experiment("standstill", "At rest", "3.2 s", loop.run(3.2, {}, {}), ("x", "y", "phi"), {})
    time = sample_times(0.3, loop.period_s)
    references = {"x": 1e-3 * np.sin(6 * time), "y": 1e-3 * (1 - np.cos(6 * time))}
    circle = Experiment(
        "circle", "Circle (Fig. 9)", "0.3 s", simulate(loop, 0.3, references, {}), ("x", "y"), references
    )
    finite = replace(step, name="step_x_finite", title="x by 20 um, finite matrix")
    return [step, finite, circle, rest]


def coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Let maps have few points, so that a page takes seconds."""
    monkeypatch.setattr(page, "PLACES", 2)
    monkeypatch.setattr(sensing_maps, "SPEED", 2.0)
    monkeypatch.setattr(drawings, "POINTS", 8)
    monkeypatch.setattr(page, "MAP_POINTS", 3)
