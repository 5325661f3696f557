"""What the documentation, datasheet and manifest say of the safe output is what the fault campaign measures today.

A closed loop with encoders is reproducible in its metrics, to about 1 %, and not to the last digit.
"""

import json
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from synth.app import fault_jobs, workspace
from synth.app.commands import SAFE_OUTPUT
from synth.base import jobs, progress
from synth.declare.fault_campaign import SafeOutput, read_safe_output

pytestmark = pytest.mark.whole

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "howto" / "judge-faults-on-the-machine.md"
CLOSED = ("levitator_2dof", "maglev_5dof", "maglev_5dof_precise", "planar_6dof_leadlag", "planar_6dof_lqg")
DIGITS = 0.03  # relative: three digits, and 1 % of a closed loop
SLOW = 1e-3  # of a unit per second: below it a speed is compared as such


def committed(name: str) -> SafeOutput:
    figures = read_safe_output(ROOT / "designs" / name / SAFE_OUTPUT)
    assert figures is not None
    return figures


def differences(one: SafeOutput, other: SafeOutput) -> list[str]:
    """Return what differs between two measurements by more than the loops reproduce."""
    first, second = asdict(one), asdict(other)
    different = [key for key in ("command", "plants", "runs", "latched", "units") if first[key] != second[key]]
    for what in ("speeds", "impacts"):
        for condition, speeds in first[what].items():
            again = second[what].get(condition, {})
            assert speeds.keys() == again.keys()
            different += [
                f"{what} {condition} {q}"
                for q, v in speeds.items()
                if abs(v - again[q]) > DIGITS * max(v, again[q]) + SLOW
            ]
    return different


@pytest.mark.parametrize("name", CLOSED)
def test_page_datasheet_and_manifest_quote_the_figures(name: str) -> None:
    text, folder = committed(name).text(), ROOT / "generated_c" / name
    assert f"| `{name}` | {text} |" in PAGE.read_text(encoding="utf-8")
    datasheet = (folder / f"{name}.md").read_text(encoding="utf-8")
    assert all(clause in datasheet for clause in text.split("; "))
    assert text in json.loads((folder / "manifest.json").read_text(encoding="utf-8"))["safety"]["safe_output_effect"]


@pytest.mark.slow
@pytest.mark.parametrize("name", CLOSED)
def test_the_figures_are_what_the_campaign_measures(name: str) -> None:
    (design,) = workspace.designs(ROOT, [name])
    figures = committed(name)
    parts = fault_jobs.losses(design, figures.plants)
    outcomes = jobs.run(fault_jobs.jobs(design, parts), progress.Lines(lambda about, line: None))
    measured = fault_jobs.safe_output(design, parts, outcomes)
    assert differences(figures, measured) == []
    planted = {c: {q: 1.1 * v for q, v in speeds.items()} for c, speeds in figures.speeds.items()}
    assert "speeds in motion " + max(figures.speeds["in motion"], key=figures.speeds["in motion"].__getitem__) in (
        differences(replace(figures, speeds=planted), measured)
    )
