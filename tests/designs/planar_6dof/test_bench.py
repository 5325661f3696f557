"""The sequences of both designs reach what they are there for: sections, pitches, limits, failures, every decision."""

import json
import re
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from designs.planar_6dof import allocation, bench, interface
from designs.planar_6dof_leadlag import bench as leadlag
from models import planar_stage
from synth.emit.write import Emitted
from synth.execute import host
from synth.synthesise import safety
from synth.verify import meter, rivals, steps
from synth.verify.steps import Steps

GENERATED = Path(__file__).parents[3] / "generated_c"
BARS = {"planar_6dof_leadlag": 800, "planar_6dof_lqg": 700}  # instructions that gcc's step takes at most
# gcc copies a decision into each path that leads to it, where part of it is decided: as shipped, copies of the
# diagnosis' flags go one way only. Without that each decision of the text is there once; clang copies none.
BUILDS = {
    b.name: b
    for b in (*meter.builds(), meter.Build("gcc, no copies", "gcc", ("-Os", "-fno-thread-jumps")))
    if b.name in ("zig, musl", "gcc, no copies") and b.compiler in {c.compiler for c in meter.builds()}
}
SHIPPED = {b.name: b for b in meter.builds() if b.compiler == "gcc" and "contracted" not in b.name}
THIN = 700  # steps of a sequence that is drawn at random
COSTLY = 1500  # steps of each of those where the costliest steps are
# What nothing takes both ways: how many decisions of a line, and why.
UNREACHABLE = (
    (r"limit\(.* / \(.*\), 1\.0f\)", 4, "a product of two is less than the larger one's square and a little more"),
    (r"limit\(.*, 1\.26f\)", 3, "a phase is beyond by rounding alone, and not where polynomials make it smaller"),
    (r"if \(\(guard_ready .*(fabsf.*){3}", 1, "an acceleration beyond its bound has a velocity beyond it"),
    (r"if \(\w+ && !\w+\) \{", 1, "the second is not asked where the first is known from above"),
)
LATCH = 1 << safety.LATCH_BIT


def shipped(name: str) -> Emitted:
    folder = GENERATED / name
    files = {path.name: path.read_text() for path in folder.glob("*.[ch]")}
    return Emitted(files, json.loads((folder / "manifest.json").read_text()))


@pytest.fixture(scope="module", params=BARS)
def emitted(request: pytest.FixtureRequest) -> Emitted:
    return shipped(request.param)


@pytest.fixture(scope="module")
def controller(emitted: Emitted) -> host.Controller:
    return host.load(emitted.files, emitted.manifest)


@pytest.fixture(scope="module")
def sequences(controller: host.Controller) -> dict[str, Steps]:
    return {s.name: s for s in bench.excursions(controller)}


@pytest.fixture(scope="module")
def every(sequences: dict[str, Steps]) -> Steps:
    """All sequences, those thinned that are drawn at random."""
    chosen = [s if s.name.startswith(("rare", "shaken")) else steps.thinned(s, THIN) for s in sequences.values()]
    return steps.joined("all", chosen)


def sizes(outputs: dict[str, Any]) -> np.ndarray:
    """Return the amplitude of each motor's current (3, N), A."""
    phases = [[np.asarray(outputs[f"i_{m}{p}"], dtype=float) for p in "ABC"] for m in planar_stage.MOTORS]
    return np.sqrt(2 / 3 * (np.array(phases) ** 2).sum(axis=1))


def test_the_replay_has_faults_and_a_channel_that_drops_out_latches_it(controller: host.Controller) -> None:
    replay = controller.replay(bench.replay(controller))
    words, latched = replay.faults, (replay.faults & LATCH) != 0
    first = int(np.argmax(latched))
    assert len(words) == bench.REPLAY and 9501 < first < 9600 and latched[first:].all()
    inputs = [g.signal.name for g in interface.INPUTS]
    for name in ("V_by", "d2", "V_cy", "theta_ref"):
        assert np.count_nonzero(words[:9500] >> inputs.index(name) & 1) >= 3
    assert np.count_nonzero(words[:9500]) < 100
    assert all(replay.outputs[s.name][-1] == 0 for s in interface.OUTPUTS)


def test_the_travel_goes_through_all_pairs_of_sections_both_ways_and_to_both_yaws() -> None:
    pose, pitch = bench.poses(np.random.default_rng(0)), planar_stage.plant().parameter("l").value
    x, y = (np.floor(8 * pose[axis] / pitch) % 8 for axis in "xy")
    assert set(zip(x.tolist(), y.tolist(), strict=True)) == {(i, j) for i in range(8) for j in range(8)}
    for axis in "xy":
        count = np.round(pose[axis] / pitch)
        assert set(count) == {-2, -1, 0, 1, 2} and set(np.diff(count)) == {-1, 0, 1}
    high = allocation.BOX["phi"].high
    assert all(np.count_nonzero(pose["phi"] == end) > 500 for end in (-high, high))


def test_the_controller_follows_the_travel_in_all_pitches(sequences: dict[str, Steps]) -> None:
    """Some state holds x and some state y, to within what they move in a few samples."""
    way, pose = sequences["travel"], bench.poses(np.random.default_rng(bench.SEED))
    at = np.linspace(0, bench.TRAVEL - 1, len(way)).round().astype(int)
    for axis in "xy":
        off = [np.abs(way.states[n] - pose[axis][at])[10:].max() for n in way.states.dtype.names or ()]
        assert min(off) < 3e-3


def test_all_motors_stand_at_their_limits_at_once_and_none_goes_beyond(
    controller: host.Controller, sequences: dict[str, Steps]
) -> None:
    found = sizes(steps.taken(controller, sequences["saturated"]).outputs)
    assert np.mean(np.all(found > 0.999 * allocation.LIMIT, axis=0)) > 0.2
    assert found.max() < allocation.LIMIT * (1 + 3e-5)  # the polynomials change a current's size by 2e-5
    ends = steps.taken(controller, sequences["shaken, at ends"]).outputs
    for s in interface.OUTPUTS:
        assert all(np.count_nonzero(ends[s.name] == np.float32(end)) > 10 for end in (s.low, s.high))


def test_every_input_fails_and_each_hall_channel_is_suspected(
    controller: host.Controller, sequences: dict[str, Steps]
) -> None:
    words = steps.taken(controller, sequences["faults"]).faults
    for bit in range(len(interface.INPUTS)):
        assert {0, 1} == set((words[words & LATCH == 0] >> bit & 1).tolist())
    again = steps.taken(controller, sequences["failures, again"])
    before, after = sequences["failures, again"].states, again.states
    flags = [f["name"] for f in controller.manifest["structs"]["state"]["fields"] if f["ctype"] == "uint32_t"]
    for name in planar_stage.HALL:
        assert any(name in flag and np.any(after[flag] > before[flag]) for flag in flags), name


def test_latches_slew_from_large_currents_to_none(controller: host.Controller, sequences: dict[str, Steps]) -> None:
    found = sequences["latches"]
    outputs = steps.taken(controller, found).outputs
    ends = np.arange(bench.KEPT - 1, len(found), bench.KEPT)
    assert len(ends) == len(bench.LATCHED)
    for s in interface.OUTPUTS:
        assert np.all(outputs[s.name][ends] == 0)
        inside = np.delete(np.abs(np.diff(outputs[s.name])), ends[:-1])
        assert inside[interface.BAD_SAMPLES :].max() > 0
    assert sizes(outputs)[:, ends - bench.KEPT + 1].max() > allocation.QUADRATURE * 0.99


def unexplained(missing: tuple[str, ...]) -> list[str]:
    """Return decisions that were not seen both ways and for which UNREACHABLE has no reason."""
    lines, left = Counter(text.split("; ")[-1] for text in missing), []
    for text in missing:
        line = text.split("; ", 1)[-1]
        if not any(re.search(pattern, line) and lines[line] <= most for pattern, most, _ in UNREACHABLE):
            left.append(text)
    return left


@pytest.mark.parametrize("build", BUILDS)
def test_every_decision_is_seen_both_ways(build: str, emitted: Emitted, every: Steps) -> None:
    own = rivals.emitted(emitted)
    found = meter.covered(own, meter.run(own, every, BUILDS[build]), BUILDS[build])
    assert found.decisions > 100 and len(found.missing) < 20
    assert not unexplained(found.missing), "\n".join(unexplained(found.missing))


def test_a_decision_that_nothing_takes_is_told(emitted: Emitted, every: Steps) -> None:
    """The planted defect: a branch on a value that no step has."""
    name = f"{emitted.manifest['design']}.c"
    text = emitted.files[name].replace(
        "    return faults;", "    if (in->V_ax == 1.2345678f) { faults |= 1u << 30; }\n    return faults;"
    )
    planted, build = Emitted({**emitted.files, name: text}, emitted.manifest), next(iter(BUILDS.values()))
    own = rivals.emitted(planted)
    found = meter.covered(own, meter.run(own, steps.thinned(every, 500), build), build)
    assert [line for line in unexplained(found.missing) if "1.2345678f" in line]


def test_what_the_failures_are_for_is_told_without_them(emitted: Emitted, sequences: dict[str, Steps]) -> None:
    """The planted defect: a meter that leaves the failures out. No channel is named then, and no input refused."""
    own, build = rivals.emitted(emitted), next(iter(BUILDS.values()))
    sound = steps.thinned(sequences["travel"], THIN)
    left = unexplained(meter.covered(own, meter.run(own, sound, build), build).missing)
    for name in planar_stage.HALL:
        assert any(f"found_{name}" in line for line in left)
    assert any("5.0f" in line for line in left)


@pytest.mark.parametrize("build", SHIPPED)
def test_the_costliest_step_keeps_its_bar(build: str, emitted: Emitted, sequences: dict[str, Steps]) -> None:
    costly = [s for s in sequences.values() if s.name.endswith(("anew", "thrice")) or s.name == "corners"]
    given = steps.joined("costly", [steps.thinned(s, COSTLY) for s in costly])
    found = meter.run(rivals.emitted(emitted), given, SHIPPED[build])
    assert found.cost.instructions.max() <= BARS[emitted.manifest["design"]]


def test_closed_loops_are_all_experiments_and_the_replay() -> None:
    """One of the designs stands for both: the same function makes them."""
    emitted = shipped("planar_6dof_leadlag")
    controller = host.load(emitted.files, emitted.manifest)
    told: list[str] = []
    found = leadlag.sequences(controller, told.append)
    loops = {s.name: s for s in found if s.closed_loop}
    assert {"step_x", "circle", "standstill", "zero_moving", "replay"} < set(loops) and told
    assert [s.closed_loop for s in found] == sorted((s.closed_loop for s in found), reverse=True)
    assert all(0 < len(s) <= bench.EACH for s in loops.values())
    circle = steps.taken(controller, loops["circle"])
    assert not circle.faults.any() and leadlag.FLOOR == bench.FLOOR
