"""Hostile calls: a fixed part of the search, and functions without a guard, which it must find."""

import importlib
import inspect
import types
import typing
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from synth.errors import SignalError
from synth.statespace import readonly
from tests.hostile import search as hostile
from tests.hostile.values import KINDS, SELDOM_RIGHT

PATIENCE_S = 60.0  # a loaded machine decides nothing here; the command holds each call to its limit
REFUSALS = 20_600  # of 21,632 calls; those answered are texts, numbers, lists and None where they are right
ANSWERED = {  # by the arguments that take a kind of value that few take
    "block.ComputedSignal.certificate": {"a function"},
    "block.clip.expr": {"a symbol"},
    "statespace.coefficients.system": set(SELDOM_RIGHT),  # it looks whether an object is a transfer function
    "glsdc_integrity.Integrity.groups": {"an array of texts"},
    "structure.pair.value": {"a complex number"},
    "transfer.closed_loop_poles.factor": {"a complex number"},
}
# Read by another function; an array has its own name from NumPy 2.5 on.
READ = ("ndarray", "NDArray", "arb_mat", "casadi.SX", "Jacobian", "Solution", "Partition", "Curve", "Equation")
INNER = {  # modules whose functions take what others have read
    *("digits", "precise", "staircase", "structured_peak", "structured_singular_value", "equation", "exact"),
    *("derivatives", "solvability", "weights", "statespace", "crossings"),
    *(
        "grid_crossings",
        "zpk",
        "sturm",
        "nearest_root",
        "resolvent",
        "isolated_zeros",
        "glsdc",
        "error_map",
    ),
    "phasor",
    *("axis_regulator", "glsdc_model", "glsdc_jacobian", "glsdc_solution", "glsdc_integrity", "glsdc_monitor"),
}
INNER_FUNCTIONS = {  # likewise, of other modules
    "axis": {"servo_blocks"},
    "disk": {"of_rational", "of_model", "is_stable"},
    "equilibrium": {"of_loop"},
    "fault": {"with_reactions", "enumeration"},
    "glsdc_estimator": {"of_solution", "of_monitor", "of_search"},
    "identify": {"Problem", "problem", "TrajectoryFit", "refine_steps"},
    "lqr": {"PeriodCost", "over_period"},
    "magnitude": {"equilibrated", "is_singular"},
    "reduced_observer": {"of_model", "measurement_rows"},
    "redundancy": {"of_redundancy"},
    "redundancy_decision": {
        "numbers_of_relation",
        "inputs",
        "outputs",
        "states",
        "inputs_of_monitor",
        "outputs_of_monitor",
        "states_of_monitor",
    },
    "regulator_equations": {"roots", "polynomial", "modal_matrix"},
    "safety": {"limit", "ends", "of_guard", "full", "state", "numbers", "rule", "check", "about_left", "latch"},
    "stability_margins": {"of_rational", "of_delayed_loop", "of_many_states"},
    "transfer": {"schur_response"},
}


@pytest.fixture(scope="module")
def outcomes() -> list[tuple[hostile.Case, hostile.Outcome]]:
    return hostile.search(600, seed=20, limit_s=PATIENCE_S)


def test_a_fixed_part_of_the_search_finds_no_defect(
    outcomes: Sequence[tuple[hostile.Case, hostile.Outcome]],
) -> None:
    defects = [hostile.report([(case, outcome)]) for case, outcome in outcomes if outcome.is_defect]
    assert not defects, "\n".join(defects)


def test_the_part_is_refused_and_answered_over_the_whole_library(
    outcomes: Sequence[tuple[hostile.Case, hostile.Outcome]],
) -> None:
    kinds = [outcome.kind for _, outcome in outcomes]
    assert kinds.count("answer") > 30 and kinds.count("refused") > 300
    assert len({case.name for case, _ in outcomes}) > 100


@pytest.fixture(scope="module")
def kinds() -> list[tuple[hostile.Case, hostile.Outcome]]:
    """One call for each kind of value and each argument of the library."""
    return hostile.evaluate_each(
        [case for case in hostile.cases() if case.mutation in KINDS or case.mutation.startswith(hostile.SAME)],
        limit_s=PATIENCE_S,
    )


def test_no_kind_of_value_of_any_argument_makes_a_defect(
    kinds: Sequence[tuple[hostile.Case, hostile.Outcome]],
) -> None:
    defects = [(case, outcome) for case, outcome in kinds if outcome.is_defect]
    assert not defects, hostile.report(defects)


def test_each_argument_refuses_every_kind_but_its_own(
    kinds: Sequence[tuple[hostile.Case, hostile.Outcome]],
) -> None:
    """On each version of Python and of NumPy alike: where an annotation is not read, more is answered."""
    answered: dict[str, set[str]] = {}
    for case, outcome in kinds:
        if case.mutation in SELDOM_RIGHT and outcome.kind != "refused":
            answered.setdefault(f"{case.name}.{case.argument}", set()).add(case.mutation)
    assert answered == ANSWERED
    assert sum(outcome.kind == "refused" for _, outcome in kinds) >= REFUSALS


def judge(function: Callable[..., Any], bad: Any, limit_s: float = PATIENCE_S, how: str = "planted") -> str:
    case = hostile.Case("planted.function", function, {"x": bad}, "x", how)
    return hostile.evaluate(case, function(1.0), limit_s).kind


def endless(x: float) -> float:
    while x != 1.0:
        pass
    return x


def careful(x: float) -> float:
    if not isinstance(x, float):
        raise SignalError(f"x is {x!r}: give a number")
    return x


@pytest.mark.parametrize(
    ("function", "bad", "kind"),
    [
        (lambda x: x + 1.0, "text", "raw error"),
        (lambda x: [1.0][int(x) - 1], 3, "raw error"),
        (lambda x: {"root": 2.0 * x}, np.nan, "NaN"),
        (lambda x: float(np.float64(1.0) / np.float64(x)), 0.0, "warning"),
        (endless, 2.0, "too slow"),
        (careful, "text", "refused"),
        (careful, 2.0, "answer"),
    ],
)
def test_a_planted_defect_is_named(function: Callable[..., Any], bad: Any, kind: str) -> None:
    assert judge(function, bad, 0.2 if kind == "too slow" else PATIENCE_S) == kind


def test_another_answer_to_the_same_value_is_a_defect() -> None:
    def by_form(x: Any) -> float:
        return 2.0 if isinstance(x, np.float64) else float(x)

    assert judge(by_form, np.float64(1.0), how=f"{hostile.SAME}a NumPy scalar") == "wrong"
    assert judge(careful, np.float64(1.0), how=f"{hostile.SAME}a NumPy scalar") == "answer"


def test_a_function_of_the_library_without_its_guard_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    lead_lag = importlib.import_module("synth.synthesise.classical.lead_lag")
    guarded = lead_lag.from_time_constants
    assert not any(outcome.is_defect for _, outcome in hostile.search(60, 0, "lead_lag.from_time_constants"))
    monkeypatch.setattr(lead_lag, "from_time_constants", guarded.__wrapped__)
    monkeypatch.setattr(hostile, "is_checked", lambda target: target is guarded.__wrapped__)
    monkeypatch.setattr(hostile, "library", hostile.library.__wrapped__)
    assert any(outcome.is_defect for _, outcome in hostile.search(60, 0, "lead_lag.from_time_constants"))


def is_rim(function: Callable[..., Any]) -> bool:
    """Tell whether a function has arguments, and none that another has read already."""
    hints: Mapping[str, Any] = {k: v for k, v in typing.get_type_hints(function).items() if k != "return"}
    return bool(hints) and not any(name in str(hint) for hint in hints.values() for name in READ)


def test_every_public_function_that_reads_for_itself_is_checked() -> None:
    bare = []
    for module in hostile.modules():
        short = module.__name__.rpartition(".")[2]
        for name, target in vars(module).items():
            is_public = getattr(target, "__module__", "") == module.__name__ and not name.startswith("_")
            inner = short in INNER or target is readonly  # which copies any array into a frozen field
            if is_public and isinstance(target, types.FunctionType) and not inner:
                inner = name in INNER_FUNCTIONS.get(short, ())
                bare += [f"{short}.{name}"] if not inner and not hostile.is_checked(target) and is_rim(target) else []
    assert not bare, f"put @arguments.checked before {', '.join(bare)}"


def test_every_checked_function_has_an_example_that_works() -> None:
    for name, function in hostile.library().items():
        assert set(hostile.example(name, function)) <= set(inspect.signature(function).parameters), name
