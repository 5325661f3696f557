"""The stimuli reach every decision of the C with protection levels, but for limits that no pose and voltage comes near.

What is measured is the committed C.
"""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from designs.hall_position import reference_protected as reference
from designs.hall_position import verification_protected as verification
from designs.hall_position.protected import config, stimuli
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.verify import meter, steps
from synth.verify.meter import Build
from tests import tools

GENERATED = Path(__file__).parents[4] / "generated_c"
ONCE = Build("gcc, no copies", "gcc", ("-Os", "-fno-thread-jumps"))  # as in test_stimuli of two sensors
THIN, POSES, MOST = 400, 20_000, 27  # steps of a sequence; poses; decisions that are not seen both ways
UNREACHED = {
    "information in the dynamic range": r"in_range|passes = |\)\) && decides",
    "amplitude resolved": r"deviation_amplitude|variance_amplitude",
    "chi-square below 1e9": r"float chi_square = ",
    "least pivots of the solution": r"(inverse|diagonal)_\w+ = 1\.0f / \w+_max\(|_max\(left_3_3 .*, least_pivot_yaw\)",
    "least pivots of a hypothesis": r"gain_\w+ = 1\.0f / \w+_max\(|_max\(1\.0f - |detectable|gain(_\d)? < largest_gain",
    "a level without one sensor beyond its limit, where that before it is not": r"left_\d_\d\w* <= ",
    "places beyond the range along Y alone": r"bool valid = .*fabsf\(count_y\)",
    "a number of an excluded sensor above the last one, or below 0": r"= \w+_equal\(x_excluded, |if \(!none\)",
    "the last start once more, on a path that knows it: the case itself is taken": r"\(last\) \? 0u|!last \|\| unique",
    "sums of squares, below 0 by rounding only": r"_(part|limited)\w* = \w+_max\(0\.0f, |(full|chi).* = \w+_max\(",
    "a limit of chi-square beyond the largest one": r"_min\(inverse_channel_variance \* ",
}


def committed(name: str) -> EmittedCode:
    folder = GENERATED / name
    files = {p.name: p.read_text() for p in folder.glob("*.[ch]")}
    return EmittedCode(files, json.loads((folder / "manifest.json").read_text()))


def missing_decisions(emitted: EmittedCode) -> tuple[int, list[str]]:
    """Return the number of decisions, and those that the stimuli do not take both ways."""
    sequences = stimuli.sequences(host.load(emitted.files, emitted.manifest))
    every = steps.concatenate("all", [s if "ends" in s.name else steps.thinned(s, THIN) for s in sequences])
    candidate = meter.emitted_source(emitted)
    coverage = meter.coverage(candidate, meter.run(candidate, every, ONCE), ONCE)
    return coverage.decisions, list(coverage.missing)


@tools.needs_arm_gcc
@pytest.mark.parametrize("name", config.PLACES)
def test_every_decision_is_seen_both_ways_or_is_out_of_reach(name: str) -> None:
    decisions, missing = missing_decisions(committed(name))
    assert decisions > 150 and len(missing) <= MOST
    assert [line for line in missing if not re.search("|".join(UNREACHED.values()), line)] == []


@pytest.mark.parametrize("name", config.PLACES)
def test_every_sequence_has_steps_and_a_name_of_its_own(name: str) -> None:
    emitted = committed(name)
    sequences = stimuli.sequences(host.load(emitted.files, emitted.manifest))
    lengths = {s.name: len(s) for s in sequences}
    assert len(lengths) == len(sequences) and min(lengths.values()) > 0
    assert lengths["doubted"] > 40


@pytest.mark.parametrize("name", config.PLACES)
def test_what_no_stimulus_reaches_is_far_from_any_pose_and_voltage(name: str) -> None:
    """Information is at most 1 % of its limit, the amplitude's variance 30 %, its pivot 3 times the least."""
    setup, rng = verification.setup(name), np.random.default_rng(0)
    low, high, _ = reference.ranges(setup)
    volts = rng.uniform(-5, 5, (POSES, len(setup.positions), 2))
    floors, prior = reference.floors(setup), reference.prior(setup)
    _, H = reference.linearise(setup, rng.uniform(low, high, (POSES, 4)), volts)
    for left_out in range(len(setup.positions) + 1):
        used = np.repeat(np.arange(1, len(setup.positions) + 1) != left_out, 2)
        N = np.swapaxes(H * used[None, :, None], 1, 2) @ H + np.diag(prior)
        information = np.diagonal(N, axis1=1, axis2=2) / (reference.RANGE**2 * floors)
        pivot = np.linalg.cholesky(N)[:, 3, 3] ** 2 / floors[3]
        variance = np.linalg.inv(N)[:, 3, 3] * floors[3]
        assert information.max() < 0.012
        if name != config.THREE or not left_out:  # of two sensors alone the amplitude may reach its least pivot
            assert pivot.min() > 3 and variance.max() < 0.3
