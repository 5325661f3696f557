"""Tables of constants: looked up as CasADi does, by an index that is proved to stay inside, or not emitted."""

from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build, clip, table
from synth.emit.program import lower
from synth.emit.proof.interval import Interval, lookup
from synth.emit.write import EmittedCode, emit
from synth.errors import EmitError, SignalError
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete
from synth.verify.proofs import eva
from tests import tools

pytestmark = pytest.mark.slow

VALUES = (0.1, -2.5, 3.0, 0.7, 11.0)
LAST = len(VALUES) - 1
PLACE, OUT = Signal("place", "1", -10, 10), Signal("value", "1", -100, 100)


def lookup_block(low: float = 0, high: float = LAST, name: str = "numbers") -> Block:
    """Return the Block that looks up a table at the whole part of an input limited to low .. high."""

    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"value": table(name, VALUES)(ca.floor(clip(u["place"], Signal("index", "1", low, high))))})

    return build("lookup", Discrete(1e-3), law, inputs=[PLACE], outputs=[OUT])


def answers(made: EmittedCode, place: np.ndarray) -> np.ndarray:
    return host.load(made.files, made.manifest).replay({"place": place}).outputs["value"]


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_every_value_is_looked_up_and_the_ends_extend(scalar: type[np.floating]) -> None:
    place = np.array([-10.0, -0.5, -0.0, 0.0, 0.999, 1.0, 2.5, 3.0, 3.999, 4.0, 4.5, 10.0])
    expected = np.array(VALUES, scalar)[np.clip(np.floor(place), 0, LAST).astype(int)]
    np.testing.assert_array_equal(answers(emit(lookup_block(), scalar), place), expected)
    seen = np.ravel([lookup_block().function()([], v)[1] for v in place])
    np.testing.assert_array_equal(seen.astype(scalar), expected)


@pytest.mark.parametrize(
    ("low", "high", "need"), [(0, LAST + 1, "index must lie in 0 .. 4"), (-1, LAST, "index must lie in 0 .. 4")]
)
def test_an_index_that_may_leave_the_table_is_not_emitted(low: float, high: float, need: str) -> None:
    with pytest.raises(EmitError, match=need):
        emit(lookup_block(low, high), np.float32)


def test_a_table_is_printed_once_before_the_step_that_reads_it() -> None:
    text = emit(lookup_block(), np.float32).files["lookup.c"]
    assert text.count("static const float numbers[5] = {") == 1
    assert text.index("static const float numbers") < text.index("uint32_t lookup_step") < text.index("numbers[(uint")


def test_two_tables_of_one_name_are_refused() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        index = ca.floor(clip(u["place"], Signal("index", "1", 0, LAST)))
        return Step({"value": table("numbers", VALUES)(index) + table("numbers", VALUES[::-1])(index)})

    with pytest.raises(EmitError, match="'numbers' has the name of another"):
        emit(build("lookup", Discrete(1e-3), law, inputs=[PLACE], outputs=[OUT]), np.float32)


@pytest.mark.parametrize("name", ["place", "k"])
def test_a_table_with_the_name_of_a_signal_or_constant_is_refused(name: str) -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"value": k["k"] * table(name, VALUES)(ca.floor(ca.fabs(u["place"]) / 5))})

    constants = [Constant("k", 2.0, "1", "test")]
    with pytest.raises(EmitError, match=f"'{name}' has the name of another"):
        lower.program(build("lookup", Discrete(1e-3), law, inputs=[PLACE], outputs=[OUT], constants=constants))


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize(
    "name",
    [
        "min",
        "max",
        "limit",
        "flag",
        "state",
        "in",
        "out",
        "faults",
        "uint32_t",
        "bool",
        "sinf",
        "t1",
        "value",
        "a_polynomial",
    ],
)
def test_a_table_may_have_a_name_that_the_c_reserves(name: str, scalar: type[np.floating]) -> None:
    """Beside its name with an underscore, and a use of `min`, `max`, `limit`, `bool` and states."""

    def law(u: Any, x: Any, k: Any) -> Step:
        index = ca.floor(clip(u["place"], Signal("index", "1", 0, LAST)))
        kept = ca.fmax(ca.fmin(u["place"], k["high"]), -k["high"])
        y = table(name, VALUES)(index) + table(f"{name}_", VALUES[::-1])(index) + ca.sin(kept)
        return Step(
            {"answer": ca.if_else(ca.logic_and(u["place"] > 1, x["n"] < 3), y, kept)}, {"n": ca.fmin(x["n"] + 1, 7)}
        )

    answer, high = Signal("answer", "1", -100, 100), Constant("high", 2.0, "1", "test")
    states = [State(Signal("n", "1", 0, 7), 0, integer=True)]
    block = build("lookup", Discrete(1e-3), law, inputs=[PLACE], outputs=[answer], states=states, constants=[high])
    place = np.array([-3.0, 1.5, 2.5, 3.5, 0.5])
    made = emit(block, scalar)
    answers = host.load(made.files, made.manifest).replay({"place": place}).outputs["answer"]
    f, n, expected = block.function(), 0.0, []
    for p in place:
        n, y = (float(v) for v in f(n, p))
        expected.append(y)
    np.testing.assert_allclose(answers, expected, rtol=2.0**-20)


@pytest.mark.parametrize("name", ["while", "null", "jac", "two__underscores"])
def test_a_table_with_a_keyword_as_name_is_refused(name: str) -> None:
    with pytest.raises(SignalError, match=f"table name '{name}'"):
        table(name, VALUES)


@pytest.mark.parametrize("values", [((1.0, 2.0), (3.0, 4.0)), ("a", "b"), None, 3.0])
def test_values_that_are_not_a_row_of_numbers_are_refused(values: Any) -> None:
    with pytest.raises(SignalError, match=r"`values` of `block.table` is .*: give a list, each entry a number"):
        table("numbers", values)


def test_a_call_of_another_function_is_refused() -> None:
    x = ca.MX.sym("x")
    called = ca.Function("called", [x], [ca.sin(x)], {"never_inline": True})

    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({"value": called(u["place"])})

    with pytest.raises(EmitError, match="'called', which is not a table"):
        lower.program(build("lookup", Discrete(1e-3), law, inputs=[PLACE], outputs=[OUT]))


@pytest.mark.parametrize(("name", "values"), [("two words", VALUES), ("t", (1.0,)), ("t", (1.0, float("nan")))])
def test_an_invalid_table_is_refused(name: str, values: tuple[float, ...]) -> None:
    with pytest.raises(SignalError):
        table(name, values)


def test_a_lookup_is_enclosed_by_the_values_in_its_index_range() -> None:
    ends = np.array([[0.0, 1.5], [1.0, 3.99], [4.0, 4.0], [-np.inf, np.inf]]).T
    y = lookup(VALUES, Interval(ends[0], ends[1], np.zeros(4, bool)))
    np.testing.assert_array_equal(y.low, [-2.5, -2.5, 11.0, -2.5])
    np.testing.assert_array_equal(y.high, [0.1, 3.0, 11.0, 11.0])


@tools.needs("frama-c", shows="that a lookup reads inside its table, and that a wider index does not")
def test_the_access_is_proved_and_a_wider_index_is_not() -> None:
    made = emit(lookup_block(), np.float32)
    assert eva.prove(made.files, made.manifest).alarms == ()
    text = made.files["lookup.c"]
    wider = text.replace("min(place, 4.0f)", "min(place, 5.0f)")
    assert wider != text
    alarms = eva.prove({**made.files, "lookup.c": wider}, made.manifest).alarms
    assert any("index_bound" in alarm for alarm in alarms)
