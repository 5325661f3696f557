"""The search for optimistic margins: a fixed part of it, and defects that it must notice."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks import margins as search
from benchmarks import margins_cases
from synth.analyse.loops import crossings, stability_margins
from synth.analyse.loops.stability_margins import Margins
from synth.statespace import StateSpace, readonly
from synth.timing import Discrete


def test_no_margin_of_a_hundred_random_loops_is_optimistic() -> None:
    outcomes = list(search.search(100, seed=3))
    assert [(o.case.kind, o.worst, o.excess) for o in outcomes if o.excess > search.TOLERANCE] == []
    answered = [o for o in outcomes if not o.refused]
    assert len(answered) >= 85 and {o.case.kind for o in answered} == set(margins_cases.KINDS)
    assert all("not determined" in o.refused or "hides whether" in o.refused for o in outcomes if o.refused)


@pytest.mark.parametrize("part", ["gain", "phase", "delay", "modulus"])
def test_a_margin_that_is_reported_a_thousandth_too_large_is_noticed(
    part: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The planted defects."""
    of_loop = stability_margins.of_loop

    def optimistic(loop: object) -> Margins:
        outcomes = of_loop(loop)
        more = 1.001
        gains = tuple(
            replace(
                c,
                phase_margin=c.phase_margin * (more if part == "phase" else 1),
                delay_margin=c.delay_margin * (more if part == "delay" else 1),
            )
            for c in outcomes.gain_crossings
        )
        rising = [c for c in outcomes.phase_crossings if c.gain_margin > 1]
        phases = tuple(replace(c, gain_margin=c.gain_margin * (more if part == "gain" else 1)) for c in rising)
        peak = outcomes.peak_sensitivity / (more if part == "modulus" else 1)
        return replace(outcomes, gain_crossings=gains, phase_crossings=phases, peak_sensitivity=peak)

    monkeypatch.setattr(stability_margins, "of_loop", optimistic)
    cases = [(kind, k) for kind in margins_cases.KINDS[:2] for k in range(12)]
    outcomes = [search.compare_with_truth(margins_cases.case(kind, np.random.default_rng(k))) for kind, k in cases]
    assert any(o.excess > search.TOLERANCE and o.worst == part for o in outcomes)


def test_the_judge_answers_at_a_pole() -> None:
    one, zero = readonly([[1.0]]), readonly([[0.0]])
    model = StateSpace(one, one, one, zero, ("x",), ("u",), ("y",), Discrete(1.0))
    with np.errstate(all="ignore"):
        at_pole, beside = np.abs(margins_cases._matrices(model, 1.0)(np.array([0.0, 0.5])))
    assert not at_pole < 1e300 and beside == pytest.approx(1 / (2 * np.sin(0.25)))


def test_a_crossing_that_is_left_out_is_noticed_by_the_library_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without its phase crossing a loop has no gain margin: the closed loop at a hundredfold gain contradicts."""
    monkeypatch.setattr(crossings, "_phase_crossings", lambda *_: ())
    outcomes = [
        search.compare_with_truth(margins_cases.case("transfer function", np.random.default_rng(k))) for k in range(20)
    ]
    assert any("fails its verification" in o.refused for o in outcomes)
