"""A law labels its expressions; their names in C come from the labels and from the declaration, never from Python."""

import ast
import json
import re
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from types import CodeType
from typing import NamedTuple

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Exprs, Step, build
from synth.composition import compose
from synth.emit import pipeline, write
from synth.errors import SignalError
from synth.execute import host
from synth.law import call, label, record
from synth.signals import Signal
from synth.timing import Discrete
from tests import renamed_locals

ROOT = Path(__file__).parents[1]
DESIGNS = sorted(p.parent.name for p in (ROOT / "designs").glob("*/design.py"))
T = Discrete(1e-3)
X, Y = Signal("x", "m", -1.0, 1.0), Signal("y", "m", -4.0, 4.0)
x = ca.SX.sym("x")


@dataclass(frozen=True, eq=False)
class Wave:
    sine: ca.SX
    cosine: ca.SX


class Limits(NamedTuple):
    low: ca.SX
    high: float


def labels_of(law: Callable[[], object]) -> dict[str, str]:
    return {name: str(expr) for name, expr in record(law)[1]}


def test_the_last_label_of_an_expression_counts() -> None:
    def root() -> ca.SX:
        value = x + 1
        label(inner=value)
        return value

    def law() -> None:
        a = root()
        label(shifted=a, doubled=2 * a)

    assert labels_of(law) == {"shifted": "(x+1)", "doubled": "(2.*(x+1))"}


def test_what_contains_expressions_names_each() -> None:
    def law() -> None:
        label(force={"x": x + 1, "force_z": x + 2}, wave=Wave(x + 3, x + 4), bounds=Limits(x + 5, 1.0), pair=(x + 6, x))
        label(J=ca.vertcat(x + 8, x + 9), R=ca.blockcat([[x + 10, x + 11], [x + 12, 0]]))
        label("y1", gap=x + 13)
        label("y1", "z", slope=[x + 14])
        label(column=ca.vertcat(*(x + k for k in range(20, 30))))

    expected = {"force_x", "force_z", "wave_sine", "wave_cosine", "bounds_low", "pair_1", "J_1", "J_2"}
    expected |= {"R_11", "R_21", "R_12", "gap_y1", "slope_y1_z_1", *(f"column_{k}" for k in range(1, 11))}
    assert labels_of(law).keys() == expected


def test_inputs_and_numbers_keep_their_names() -> None:
    def law() -> None:
        label(input=x, number=ca.SX(2.0), zero=0, missing=ca.SX(1, 1))

    assert labels_of(law) == {}


def test_outside_a_law_nothing_happens() -> None:
    label(shifted=x + 1)
    assert labels_of(lambda: None) == {}


@pytest.mark.parametrize(
    ("of", "value", "message"),
    [
        ((), "text", r"label 'gap' is of 'text': give expressions of CasADi's SX"),
        ((), {"1 st": x + 1}, r"label name 'gap_1 st' is no identifier of C"),
        (("a-b",), x + 1, r"label name 'gap_a-b' is no identifier of C"),
    ],
)
def test_what_names_no_expression_is_refused(of: tuple[str, ...], value: object, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        label(*of, gap=value)


def test_an_expression_of_another_block_is_refused() -> None:
    def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
        label(foreign=ca.SX.sym("other") + 1)
        return Step({"y": u["x"]})

    with pytest.raises(SignalError, match=r"block 'square' uses 'other', which is none of its inputs"):
        build("square", T, law, inputs=[X], outputs=[Y])


def _quartic(name: str, source: Signal, target: Signal) -> Block:
    def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
        square = u[source.name] ** 2
        label(square=square, unused=square + 3)
        return Step({target.name: square + square**2})

    return build(name, T, law, inputs=[source], outputs=[target])


def test_a_composition_keeps_the_labels_and_emission_drops_those_of_values_that_nothing_needs() -> None:
    z = Signal("z", "m", -25.0, 25.0)
    loop = compose("loop", [_quartic("first", X, Y), _quartic("second", Y, z)], inputs=["x"], outputs=["z"])
    assert [name for name, _ in loop.labels] == ["square", "unused"] * 2
    program = pipeline.reduce(loop, np.float32).program
    assert sorted(program.labels.values()) == ["square", "square"]


def test_a_value_whose_negative_is_computed_is_named_by_it() -> None:
    def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
        slope = -(ca.sin(u["x"]) + u["x"] ** 3)
        label(slope=slope)
        return Step({"y": slope * u["x"] + slope**2})

    loop = compose("loop", [build("first", T, law, inputs=[X], outputs=[Y])], inputs=["x"], outputs=["y"])
    program = pipeline.reduce(loop, np.float32).program
    assert [*program.labels.values()] == ["minus_slope"]
    (k,) = program.labels
    assert program.nodes[k].op == "add"


def test_a_label_is_a_local_of_the_c_and_another_one_changes_nothing_else() -> None:
    def made(name: str) -> str:
        def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
            square = u["x"] ** 2
            label(**{name: square})
            return Step({"y": square + square**2})

        return write.emit(build("quartic", T, law, inputs=[X], outputs=[Y]), np.float32).files["quartic.c"]

    assert "const float energy = x * x;" in made("energy")
    assert re.sub(r"\benergy\b", "of_many_letters_indeed", made("energy")) == made("of_many_letters_indeed")


def _polynomial(v: ca.SX, shared: ca.SX) -> dict[str, ca.SX]:
    square = v**2
    return {"value": square * (3 + square) + shared * v, "unused": square * 7}


def _two_polynomials(named: bool) -> Callable[[Exprs, Exprs, Exprs], Step]:
    def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
        shared = u["x"] * 3 + 1
        a, b = u["x"] - 1, u["x"] + 1
        if named:
            of_a = call("polynomial_a", _polynomial, a, shared)
            of_b = call("polynomial_b", _polynomial, b * of_a["value"], shared)
        else:
            of_a = _polynomial(a, shared)
            of_b = _polynomial(b * of_a["value"], shared)
        return Step({"y": of_a["value"] + of_b["value"]})

    return law


def _emitted(named: bool) -> write.EmittedCode:
    w, wide = Signal("w", "m", -1.0, 1.0), Signal("y", "m", -1e7, 1e7)
    first = build("gain", T, lambda u, x, k: Step({"x": u["w"] ** 3 + u["w"] / 4 - u["w"] ** 2 / 4}), inputs=[w],
                  outputs=[replace(X, low=-2.0, high=2.0)])  # fmt: skip
    block = build("sum", T, _two_polynomials(named), inputs=[replace(X, low=-2.0, high=2.0)], outputs=[wide])
    loop = compose("loop", [first, block], inputs=["w"], outputs=["y"])
    return write.emit(loop, np.float32)


def test_calls_that_compute_the_same_of_other_arguments_share_a_function_of_the_c() -> None:
    text, without = (_emitted(named).files["loop.c"] for named in (True, False))
    assert len(re.findall(r"float loop_sum_polynomial\(", text)) == 1
    assert len(re.findall(r"= loop_sum_polynomial\(", text)) == 2
    assert "unused" not in text and "polynomial" not in without


def test_a_function_of_the_c_changes_no_bit() -> None:
    w = np.linspace(-1, 1, 1001)
    with_calls, without = (_emitted(named) for named in (True, False))
    y = [host.load(c.files, c.manifest).replay({"w": w}).outputs["y"] for c in (with_calls, without)]
    np.testing.assert_array_equal(*y)


def test_a_call_outside_a_law_is_a_plain_call_and_a_name_is_given_once() -> None:
    assert call("anything", lambda a, b: a + b, 1, b=2) == 3

    def law() -> None:
        call("twice", lambda: 2 * x)
        call("outer", lambda: call("twice", lambda: 3 * x))
        call("twice", lambda: 4 * x)

    with pytest.raises(SignalError, match=r"function .twice. is called twice: give each call a name"):
        record(law)
    with pytest.raises(SignalError, match="is no identifier of C"):
        call("no good name", lambda: 1)


def test_all_locals_of_a_function_get_other_names() -> None:
    law = "def law(u, *rest, k=1, **more):\n  a = u\n  return [lambda b: (a, b, c) for c in rest]"
    codes = [renamed_locals.renamed(compile(law, "law.py", "exec"))]
    names = set[str]()
    for code in codes:  # grows by the functions in each
        codes += [c for c in code.co_consts if isinstance(c, CodeType)]
        names |= {*code.co_varnames, *code.co_cellvars, *code.co_freevars} - {".0"}
    assert names == {"u", "rest", "k", "more", "a_renamed", "b", "c_renamed"}


@pytest.mark.slow
@pytest.mark.parametrize("name", DESIGNS)
def test_renaming_every_local_of_every_law_leaves_the_c_as_it_is(name: str) -> None:
    command = [sys.executable, "-m", "tests.renamed_locals", name]
    text = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    for folder, c in json.loads(text).items():
        assert c == (ROOT / "generated_c" / folder / f"{folder}.c").read_text()


def test_nothing_but_the_report_of_a_disagreement_traces_python() -> None:
    """It reads the variables of a reference, which does not import the toolkit; they are in no C."""
    tracing = {"settrace", "setprofile", "f_locals", "currentframe", "_getframe"}
    files = [p for folder in ("synth", "models", "designs") for p in (ROOT / folder).rglob("*.py")]
    names = {p: {n.attr for n in ast.walk(ast.parse(p.read_text())) if isinstance(n, ast.Attribute)} for p in files}
    traced = {str(p.relative_to(ROOT)) for p, used in names.items() if used & tracing}
    assert traced == {"synth/verify/disagreement.py"}
