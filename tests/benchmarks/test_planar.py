"""The comparison's arithmetic on the LQG cores, which are small, and the parts of both designs' steps by name."""

import json
from pathlib import Path

import numpy as np
import pytest

from benchmarks import planar
from synth.verify import baselines, meter, steps
from tests import ceilings, tools

GENERATED = Path(__file__).parents[2] / "generated_c"
GCC = ceilings.BUILDS[ceilings.O2]
PARTS = {"guard", "sensing", "filters", "prediction", "positions", "law", "allocation", "commutation", "safe output"}


@pytest.fixture(scope="module")
def costs() -> dict[str, planar.Costs]:
    return {subject.name: planar.measure(subject, GCC) for subject in planar.cores()}


@tools.needs_arm_gcc
def test_parts_add_up_to_the_mean_and_to_the_costliest_step(costs: dict[str, planar.Costs]) -> None:
    for name, subject in ((s.name, s) for s in planar.cores()):
        cost, candidate = costs[name], baselines.emitted_c(subject.emitted)
        issued = meter.run(candidate, subject.every, GCC).cost.instructions
        assert cost.most == issued.max() == sum(most for _, most in cost.parts.values())
        small = meter.run(candidate, steps.thinned(subject.within, 50), GCC).cost.instructions
        assert cost.mean == pytest.approx(small.mean(), abs=2) and cost.mean < cost.most


@tools.needs_arm_gcc
def test_the_reduced_core_costs_less_and_casadi_more(costs: dict[str, planar.Costs]) -> None:
    reduced, full = costs["reduced core"], costs["full core"]
    assert reduced.mean < 0.8 * full.mean and reduced.most < full.most
    for cost in costs.values():
        shimmed, plain = cost.ratios
        assert 1.2 < shimmed < plain and cost.bar == planar.BARS[cost.subject]


@tools.needs_arm_gcc
def test_lines_hold_what_was_measured(costs: dict[str, planar.Costs]) -> None:
    title, *rows = planar.comparison_lines(list(costs.values()))
    assert title.split()[-2:] == ["float", "CasADi"] and [row[:12].rstrip() for row in rows] == [*costs]
    cost = costs["reduced core"]
    assert rows[0].split()[-6:-4] == [str(cost.most), str(cost.bar)]
    *_, last = planar.breakdown_lines(cost)
    assert last.split() == ["in", "all", f"{cost.mean:.1f}", "100.0", "%", str(cost.most), "100.0", "%"]


@pytest.mark.parametrize("name", ["planar_6dof_leadlag", "planar_6dof_lqg"])
def test_every_block_of_a_design_is_in_a_part(name: str) -> None:
    manifest = json.loads((GENERATED / name / "manifest.json").read_text())
    block_parts = {planar.part_of(tag.split(":")[0]) for tag in manifest["trace"]}
    assert {"guard", "sensing", "law", "allocation", "commutation", "safe output"} <= block_parts <= PARTS


def test_within_a_core_no_state_is_at_its_bound() -> None:
    for subject in planar.cores():
        stepped = steps.evaluate(subject.controller, subject.within)
        fields = subject.emitted.manifest["structs"]["state"]["fields"]
        assert all(np.abs(stepped.states[f["name"]]).max() < 0.9 * f["high"] for f in fields)
