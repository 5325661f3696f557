"""Verification passes the sound estimator and detects every planted defect: in the reference, the Block and the C."""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache, partial
from typing import Any

import numpy as np
import pytest

from designs.hall_position import config, random_steps, reference_guard, verification
from designs.hall_position.glsdc import estimator
from designs.hall_position.random_steps import Subject
from designs.hall_position.reference_glsdc import Setup
from designs.hall_position.verification import Comparison, Steps
from synth.block import Block
from synth.blocks.guard import safety
from synth.check import Check
from synth.emit import write
from synth.execute import host
from synth.simulate import sampling
from synth.verify import agree, replays, suite
from synth.verify.agree import StepResults
from synth.verify.suite import Witnesses

SIZES = {"motions": 4000, "random": 2000, "edge": 2_000}
PAIR = config.NAME


@cache
def subject() -> Subject:
    return random_steps.subject()


@cache
def sound() -> Witnesses:
    return verification.witnesses(subject())


@cache
def steps_of(kind: str) -> Steps:
    of = subject()
    if kind == "motions":
        inputs = random_steps.motion_inputs(of, SIZES[kind])
        return verification.condition_steps(of, kind, *sampling.consecutive_steps(sound().c64, inputs))
    draw = {"random": random_steps.operating_steps, "edge": random_steps.edge_steps}[kind]
    return verification.condition_steps(of, kind, *draw(of, SIZES[kind]))


def failed_names(comparison: Comparison | Sequence[Check]) -> list[str]:
    checks = comparison[1] if isinstance(comparison, tuple) else comparison
    return [c.name for c in checks if not c.passed]


def failing_checks(witness: agree.Witness, kind: str = "random", name: str = "casadi") -> list[str]:
    steps = steps_of(kind)
    c64 = sound().by_name["c64"](steps.states, steps.inputs)
    return failed_names(verification.compare_double(subject(), steps, (name, witness(steps.states, steps.inputs)), c64))


def off_by(block: Block, factor: float) -> Block:
    first = block.constants[0]
    return replace(block, constants=(replace(first, value=factor * first.value), *block.constants[1:]))


@pytest.mark.whole
def test_the_sound_estimator_passes() -> None:
    of = subject()
    parts = list(verification.compare_witnesses(of, sound(), SIZES, lambda _: None))
    checks = [c for _, some in parts for c in some]
    assert [c.name for c in checks if not c.passed] == []
    pairs = {(a.what, a.first, a.second) for agreements, _ in parts for a in agreements}
    kinds = [f"{PAIR}, {kind} steps" for kind in SIZES]
    assert pairs == {(k, n, "c64") for k in kinds for n in suite.WITNESS_NAMES} | {(kinds[0], "c64", "c32")}
    counted = [c for c in checks if "condition number above" in c.name]
    assert len(counted) == 3 and all(" of " in c.about for c in counted)


def test_an_error_where_errors_are_magnified_is_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    """Planted in ill-conditioned steps only: the checks of the other steps do not see it."""
    steps, witness = steps_of("random"), sound().by_name["reference"]
    monkeypatch.setattr(verification, "ILL_CONDITIONED", 100.0)
    above = steps.severity > verification.ILL_CONDITIONED
    assert 0 < np.mean(above) < 0.5

    def corrupted(states: Any, inputs: Any) -> StepResults:
        stepped = witness(states, inputs)
        return replace(stepped, outputs={**stepped.outputs, "X": stepped.outputs["X"] + np.where(above, 1e-8, 0.0)})

    (name,) = failing_checks(corrupted)
    assert "at ill-conditioned steps" in name and not failing_checks(witness)
    assert not verification.ill_conditioned_share(steps).passed  # too many are compared so
    one = replace(steps, severity=np.ones(len(above)))
    assert verification.ill_conditioned_share(one).value == 0


def test_nan_is_detected() -> None:
    witness = sound().by_name["reference"]

    def corrupted(states: Any, inputs: Any) -> StepResults:
        stepped = witness(states, inputs)
        yaw = stepped.outputs["yaw"].copy()
        yaw[np.argmax(steps_of("random").severity)] = np.nan
        return replace(stepped, outputs={**stepped.outputs, "yaw": yaw})

    assert failing_checks(corrupted)


@cache
def wrong_in_single() -> Witnesses:
    block = off_by(subject().block, 1.001)
    files = write.emit(block, np.float32, error=estimator.SURROGATE_ERROR[np.float32])
    return replace(sound(), c32=host.load(files.files, files.manifest))


def test_single_precision_that_is_wrong_is_detected() -> None:
    of, steps = subject(), steps_of("motions")
    assert failed_names(verification.compare_single(of, sound(), steps)) == []
    names = failed_names(verification.compare_single(of, wrong_in_single(), steps))
    assert any(name.endswith("where converged") for name in names)


@pytest.mark.parametrize(
    ("output", "factor", "more"),
    [("yaw", 1.0, 1e-4), ("residual", 1.0, 1e-3), ("deviation_X", 1.01, 0.0), ("deviation_yaw", 0.9, 0.0)],
)
def test_another_output_that_is_wrong_in_single_is_detected(
    output: str, factor: float, more: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    emitted, by = agree.emitted_c, sound()

    def corrupted(controller: host.Controller) -> agree.Witness:
        def step(states: Any, inputs: Any) -> StepResults:
            stepped = emitted(controller)(states, inputs)
            wrong = np.asarray(stepped.outputs[output], dtype=np.float64) * factor + more
            return replace(stepped, outputs={**stepped.outputs, output: wrong})

        return step if controller is by.c32 else emitted(controller)

    monkeypatch.setattr(agree, "emitted_c", corrupted)
    (name,) = failed_names(verification.compare_single(subject(), by, steps_of("motions")))
    assert output.split("_")[0] in name


def test_a_wider_margin_leaves_out_too_many_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    """The share of steps left out in single precision is limited: a thousand times the margin exceeds it."""
    monkeypatch.setattr(verification, "STEP", 1000 * verification.STEP)
    (name,) = failed_names(verification.compare_single(subject(), sound(), steps_of("motions")))
    assert name.endswith("costs that differ only by rounding")


def test_a_deviation_that_is_wrong_in_double_is_detected() -> None:
    witness = sound().by_name["reference"]

    def corrupted(states: Any, inputs: Any) -> StepResults:
        stepped = witness(states, inputs)
        return replace(stepped, outputs={**stepped.outputs, "deviation_Y": stepped.outputs["deviation_Y"] * (1 + 1e-9)})

    (name,) = failing_checks(corrupted)
    assert name.endswith("deviations")


def test_decisions_of_single_precision_are_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    other = replace(
        sound(),
        c64=host.compile_block(
            replace(subject().block, faults=()), np.float64, error=estimator.SURROGATE_ERROR[np.float64]
        ),
    )
    names = failed_names(verification.compare_single(subject(), other, steps_of("motions")))
    assert any("decisions that differ" in name for name in names)


def test_free_running_witnesses_that_diverge_are_detected(monkeypatch: pytest.MonkeyPatch) -> None:
    of = subject()
    inputs = random_steps.motion_inputs(of, SIZES["motions"])
    names = failed_names(verification.free_running(of, wrong_in_single(), inputs))
    assert any("c32" in name for name in names) and not any("reference" in name for name in names)
    changed = {"deviation": 1.5 * of.setup.deviation, "beta": 1.0001 * of.setup.beta}
    other = partial(reference_guard.step, Setup(of.setup.numbers | changed))
    by = replace(sound(), by_name={**sound().by_name, "reference": agree.reference(other)})
    assert any("reference" in name for name in failed_names(verification.free_running(of, by, inputs)))


def test_motions_cross_pitches_turn_around_and_latch() -> None:
    of, n = subject(), random_steps.MOTION_SAMPLES
    inputs = random_steps.motion_inputs(of, SIZES["motions"])
    bodies = SIZES["motions"] // n
    assert inputs["V_ax"].shape == (n, bodies)
    start = {s.name: s.initial for s in of.block.states}
    outputs = replays.run(sound().by_name["c64"], start, inputs).outputs
    valid = outputs["valid"] > 0
    known = np.where(valid, outputs["X"], -np.inf).max(axis=0) - np.where(valid, outputs["X"], np.inf).min(axis=0)
    assert known.max() > 2 * of.array.pitch and np.mean(valid) > 0.2
    steps = steps_of("motions")
    yaw = np.unwrap(steps.states["estimator_yaw"].reshape(n, bodies), axis=0)
    assert np.ptp(yaw[:, 1]) > 2 * np.pi
    words = sound().by_name["c64"](steps.states, steps.inputs).faults.reshape(n, bodies)
    latched = words >> safety.LATCH_BIT > 0
    assert latched[-1].tolist() == [k % random_steps.BAD_MOTION_INTERVAL == 0 for k in range(bodies)]
    assert not latched[: random_steps.LATCHING_RUN_START].any() and set(np.unique(words & 15)) == {0, 2, 4, 8}
    assert all(
        np.mean(steps_of(kind).severity > verification.ILL_CONDITIONED) < verification.MAX_ILL_CONDITIONED
        for kind in SIZES
    )


def test_evidence_is_of_all_estimators(monkeypatch: pytest.MonkeyPatch) -> None:
    heard: list[str] = []
    check = Check("magnified", 0.0, 1.0, "1")
    monkeypatch.setattr(verification, "witnesses", lambda of: of.name)
    monkeypatch.setattr(
        verification, "compare_witnesses", lambda of, by, sizes, say: [((), [replace(check, name=f"{by} {sizes}")])]
    )
    monkeypatch.setattr(
        verification.verification_protected, "verify", lambda say, whole: ([], [replace(check, name=f"more {whole}")])
    )
    for whole, sizes in ((True, verification.FULL_STEPS), (False, verification.QUICK_STEPS)):
        evidence = verification.verify(heard.append, whole)
        expected = [f"{PAIR} {sizes}", f"more {whole}"]
        assert evidence.design == PAIR and [c.name for c in evidence.checks] == expected
    assert verification.FULL_STEPS["motions"] == 100_000 and len(heard) == 2
