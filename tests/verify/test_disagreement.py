"""A defect planted in a reference is named: what agrees before it, what does not, and by which factor."""

import inspect
import json
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from synth import show
from synth.base import contents
from synth.verify import agree, sampling, suite
from synth.verify.disagreement import Disagreement
from tests import levitator, tolerances

MODULE = levitator.design()
BLOCK = MODULE.DESIGN.controller.block


@cache
def sound() -> suite.Witnesses:
    return suite.witnesses(BLOCK, MODULE.reference.step)


def steps() -> tuple[Any, Any]:
    """Steps near rest, in which few demands reach their limits, and steps at the ends of the ranges."""
    rng = np.random.default_rng(3)
    states, inputs = sampling.edge_steps(BLOCK, rng, 8000)
    is_small = np.arange(8000) < 4000
    states |= {n: np.where(is_small, 0.01, 1.0) * v for n, v in states.items() if n.startswith("pid_")}
    states["guard_latched"] = np.where(is_small, 0, states["guard_latched"])
    return states, {n: np.where(is_small, np.nan_to_num(v) * 0.02, v) for n, v in inputs.items()}


def step(*changes: tuple[str, str]) -> Any:
    """Return the step of a reference with planted changes of its text."""
    text = inspect.getsource(MODULE.reference)
    for old, new in changes:
        assert text.count(old) == 1, f"the reference no longer holds {old!r} once"
        text = text.replace(old, new)
    names: dict[str, Any] = {"__name__": "planted"}
    exec(compile(text, "planted.py", "exec"), names)
    return names["step"]


def planted(*changes: tuple[str, str]) -> Disagreement:
    """Return where the changed reference parts from the law."""
    by_name = {**sound().by_name, "reference": agree.reference(step(*changes))}
    agreements = suite.compare("steps", replace(sound(), by_name=by_name), *steps(), None)
    assert [a.first for a in agreements if a.disagreement] == ["reference"]
    (place,) = (a.disagreement for a in agreements if a.disagreement)
    assert isinstance(place, Disagreement)
    return place


Z_DEMAND = "no variable of the reference equals 'i1_demand' of Block 'pid_z'; it reads z_error"
DEFECTS = {
    "sign of a gain": (
        "+ d * v",
        "- d * v",
        [Z_DEMAND, "'i1' of the reference less that of the law is -36 next pid_z_v"],
    ),
    "value of a gain": (
        '"x": ("i2", 2.0, 1450.0',
        '"x": ("i2", 2.0, 1405.0',
        [
            "equals 'i2_demand' of Block 'pid_x'; it reads x_error",
            "'i2' of the reference less that of the law is -45 x_error",
        ],
    ),
    "order of states": (
        '"v": np.clip(v, -width, width), "e_previous": e',
        '"v": e, "e_previous": np.clip(v, -width, width)',
        [
            "'next pid_z_v' of the reference has the value of 'next pid_z_e_previous'",
            "'next pid_z_e_previous' of the reference has the value of 'next pid_z_v'",
        ],
    ),
    "unit of an input": (
        'e = held[f"{axis}_ref"] - held[axis]',
        'e = 1e3 * held[f"{axis}_ref"] - held[axis]',
        ["equals 'z_error' of Block 'errors'; it reads z_held, z_ref_held", "the law is +999 z_ref_held"],
    ),
    "unit of a term": (
        'x[f"pid_{axis}_integral"] + d * v',
        '1e3 * x[f"pid_{axis}_integral"] + d * v',
        [Z_DEMAND, "is +999 pid_z_integral"],
    ),
    "delay by a sample": (
        "demand = p * e +",
        'demand = p * x[f"pid_{axis}_e_previous"] +',
        [Z_DEMAND, "less that of the law is -1800 z_error +1800 pid_z_e_previous"],
    ),
    "limit of an output": (
        "computed[current] = np.clip(demand, -limit, limit)",
        "computed[current] = demand",
        [
            "equals 'i1_computed' of Block 'limits'; it reads i1_demand",
            "'i1' of the reference is 40.15",
            "outside its range -3 .. 3 A",
        ],
    ),
    "limit of a state": (
        "np.clip(integral, -2 * limit, 2 * limit)",
        "integral",
        ["'next pid_x_integral' of the reference is -6.3", "its range -4 .. 4 A"],
    ),
    "period in the slew rate": (
        "SLEW * T)",
        "SLEW)",
        ["equals 'i1' of Block 'safe_output'", "it reads latched, safe_output_last_i1"],
    ),
    "start": (
        ' * x["guard_ready"]',
        "",
        [
            "every signal on the way to 'next pid_z_v' has an equal variable of the reference: it reads z_error",
            "'next pid_z_v' of the reference less that of the law is +1200 z_error -1200",
        ],
    ),
    "bad sample of a sensor": (
        'RANGES, "zx", BAD',
        'RANGES, "z", BAD',
        ["equals 'complete' of Block 'guard'; it reads good_x", "bit 31 of the fault word, 'latched', is 1, 0 by the"],
    ),
    "bit of the fault word": (
        "return after | guard.frozen(x, law, latched) | last, out, word",
        "return after | guard.frozen(x, law, latched) | last, out, word | 128",
        ["bit 7 of the fault word of the reference is 1, and no flag of 'levitator_pid' has it"],
    ),
    "order of the set-points": (
        '"z_ref": (-5e-4, 5e-4), "x_ref": (-8e-4, 8e-4)',
        '"x_ref": (-8e-4, 8e-4), "z_ref": (-5e-4, 5e-4)',
        ["bit 2 of the fault word, 'fault_z_ref', is", "bit 3 of the fault word, 'fault_x_ref', is"],
    ),
    "NaN": ("+ d * v", "+ d * v * np.nan", [Z_DEMAND, "'i1' of the reference is nan, outside its range -3 .. 3 A"]),
    "infinite": (
        "new = {",
        "computed[current] = computed[current] / 0.0\n        new = {",
        [
            "equals 'i1_computed' of Block 'limits'; it reads i1_demand",
            "'i1' of the reference is -inf",
            "outside its range -3 .. 3 A",
        ],
    ),
}


@pytest.mark.parametrize("defect", DEFECTS)
def test_a_planted_defect_is_named(defect: str) -> None:
    old, new, sentences = DEFECTS[defect]
    place = planted((old, new))
    notes = "\n".join(place.notes)
    assert all(text in notes for text in sentences), notes


def test_the_step_is_shown_with_its_inputs_states_results_and_slopes() -> None:
    place = planted(("+ d * v", "- d * v"))
    states, inputs = ({n: v[place.sample : place.sample + 1] for n, v in columns.items()} for columns in steps())
    assert all(inputs[n][0] == value for n, value in place.inputs.items()) and "x_ref" in place.inputs
    assert all(states[n][0] == value for n, value in place.states.items()) and "pid_z_v" in place.states
    law = sound().by_name["casadi"](states, inputs)
    result = next(r for r in place.results if r.name == "i1")
    assert result.law == law.outputs["i1"][0] == pytest.approx(result.c64, rel=tolerances.of("double"))
    slope = {(s.result, s.along): (s.law, s.witness) for s in place.slopes}
    D, pole = MODULE.GAINS["z"][3], MODULE.VELOCITY_POLE  # i1 = .. + D v, v = pole v + ..
    assert slope["i1", "pid_z_v"] == (pytest.approx(D * pole, rel=1e-6), pytest.approx(-D * pole, rel=1e-6))
    text = show.text(place.sheet())
    assert all(words in text for words in ("results that differ", "slopes that differ", "inputs and states", "sample"))


def test_a_defect_of_the_emitted_c_is_not_laid_upon_the_law() -> None:
    """The C of a Block with another gain stands for C that was emitted wrong."""
    other = MODULE.variant({a: MODULE.pid(a) for a in ("z", "x")}).block
    wrong = {c.name: c.value * (1.01 if c.name == "pid_z_p" else 1.0) for c in other.constants}
    witness_set = suite.witnesses(
        replace(other, constants=tuple(replace(c, value=wrong[c.name]) for c in other.constants)), MODULE.reference.step
    )
    by_name = {**sound().by_name, "c64": witness_set.by_name["c64"]}
    agreements = suite.compare("steps", replace(sound(), by_name=by_name), *steps(), None)
    place = next(a.disagreement for a in agreements if a.first == "casadi")
    assert isinstance(place, Disagreement) and place.witness == "c64" and "a defect of the toolkit" in place.notes[0]
    assert next(a.disagreement for a in agreements if a.first == "reference") is None, "it agrees with the law"


def test_what_only_replays_show_is_found_from_the_states_of_the_c() -> None:
    n = 50
    inputs = {"z": 1e-5 * np.sin(np.arange(n)), "x": np.zeros(n), "z_ref": np.zeros(n), "x_ref": np.zeros(n)}
    wrong = agree.reference(step(("+ d * v", "- d * v")))
    agreements = suite.replay(replace(sound(), by_name={**sound().by_name, "reference": wrong}), {"run": inputs}, None)
    (place,) = (a.disagreement for a in agreements if a.disagreement)
    assert isinstance(place, Disagreement) and "'i1_demand' of Block 'pid_z'" in place.notes[0]


def test_the_evidence_holds_the_disagreement_and_is_as_before_without_one() -> None:
    place = planted(("+ d * v", "- d * v"))
    agreement = agree.Agreement("reference", "c64", "steps", 1, 1.0, "i1", 0, 1.0, 0, 0.0, "", None, place)
    evidence = suite.Evidence("stage", (agreement, replace(agreement, first="casadi", disagreement=None)), ())
    document = json.loads(contents.dumps(evidence.document()))
    assert document["agreements"][0]["disagreement"]["notes"] == list(place.notes)
    assert "disagreement" not in document["agreements"][1]
    assert evidence.disagreements == [place] and place.notes[0] in show.text(evidence.sheet())
