"""Functions of one variable become polynomials, and the C keeps what their certificates promise.

Ranges are short and the errors allowed mostly large, so that a fit takes a fraction of a second.
"""

import re
from collections.abc import Callable
from typing import Any

import casadi as ca
import mpmath
import numpy as np
import pytest

from synth.block import Block, Constant, Step, build
from synth.composition import compose
from synth.emit.passes import fold, surrogates, univariate
from synth.emit.passes.surrogates import Surrogate
from synth.emit.program import lower
from synth.emit.proof import ranges
from synth.emit.write import EmittedCode, emit
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete
from tests import tolerances

pytestmark = pytest.mark.slow

TIME = Discrete(1e-3)
F32, F64 = np.float32, np.float64
COARSE = 1e-5
LOW, HIGH = 0.25, 0.5


def signal(name: str, low: float = -1e3, high: float = 1e3) -> Signal:
    return Signal(name, "1", low, high)


def make(law: Callable[..., Any], outputs: str = "y", name: str = "made", inputs: str = "a b", **fields: Any) -> Block:
    return build(
        name,
        TIME,
        lambda u, x, k: law(u, k) if isinstance(law(u, k), Step) else Step(law(u, k)),
        inputs=[signal(n, LOW, HIGH) for n in inputs.split()],
        outputs=[signal(n) for n in outputs.split()],
        **fields,
    )


def replace_functions(
    block: Block, scalar: type[np.floating] = F32, error: float | None = COARSE
) -> tuple[lower.Program, tuple[Surrogate, ...]]:
    rounded = block.rounded(scalar)
    program = fold.folded(lower.program(rounded))
    proved = ranges.analyse(program, ranges.bounds(rounded, scalar), scalar)
    return surrogates.replace_functions(program, proved, scalar, error)


def operations(program: lower.Program) -> list[str]:
    return sorted(n.op for n in program.nodes if n.op in univariate.TRANSCENDENTAL or n.op == "polynomial")


def test_functions_of_one_variable_are_found_and_replaced() -> None:
    block = make(
        lambda u, k: {"y": ca.exp(u["a"]) * u["b"], "z": ca.cosh(2 * u["b"] + k["k"]) / 3},
        "y z",
        constants=[Constant("k", 0.1, "1", "test")],
    )
    program, surrogates = replace_functions(block)
    assert operations(program) == ["polynomial", "polynomial"]
    assert {(s.tags, s.name, s.variable) for s in surrogates} == {
        (("exp(x)",), "exp_a_polynomial", "a"),
        (("z",), "z_polynomial", "b"),
    }
    assert program.polynomials == {s.name: s.polynomial for s in surrogates}
    assert all((s.polynomial.low, s.polynomial.high) == (LOW, HIGH) for s in surrogates)


def test_the_variable_may_be_any_value() -> None:
    for e, variable in ((lambda a, b: a * b, "(a * b)"), (lambda a, b: a * b + a, "(a * b) + a")):
        program, (surrogate,) = replace_functions(make(lambda u, k, e=e: {"y": ca.exp(e(u["a"], u["b"]))}))
        assert surrogate.variable == variable and operations(program) == ["polynomial"]


def test_a_function_of_two_variables_stays() -> None:
    program, surrogates = replace_functions(make(lambda u, k: {"y": ca.atan2(u["a"], u["b"])}))
    assert not surrogates and "atan2" in {n.op for n in program.nodes}


def test_a_function_with_a_zero_inside_the_range_stays() -> None:
    program, surrogates = replace_functions(
        make(lambda u, k: {"y": ca.sin(u["a"] - 0.375), "z": ca.exp(u["b"])}, "y z")
    )
    assert operations(program) == ["polynomial", "sin"] and [s.tags for s in surrogates] == [("z",)]


def test_equal_functions_share_one_polynomial() -> None:
    program, surrogates = replace_functions(
        make(lambda u, k: {"y": ca.exp(u["a"]) * u["b"], "z": ca.exp(u["b"]) * u["a"]}, "y z")
    )
    assert len(surrogates) == 1 and operations(program) == ["polynomial", "polynomial"]


def exponentials(*ends: float) -> Block:
    """Return a Block with an exponential of each of several inputs, from LOW to an end of its own."""
    names = [f"a{n}" for n in range(len(ends))]
    return build(
        "exponentials",
        TIME,
        lambda u, x, k: Step({f"y_{n}": ca.exp(u[n]) for n in names}),
        inputs=[signal(n, LOW, end) for n, end in zip(names, ends, strict=True)],
        outputs=[signal(f"y_{n}") for n in names],
    )


def test_equal_functions_share_the_widest_range_that_needs_no_higher_degree() -> None:
    (surrogate,) = replace_functions(exponentials(HIGH, 0.9 * HIGH, 0.8 * HIGH))[1]
    (alone,) = replace_functions(exponentials(HIGH))[1]
    assert surrogate.polynomial == alone.polynomial
    assert surrogate.variable == "a0, a1, a2"


def test_a_polynomial_that_costs_a_narrow_range_a_higher_degree_is_not_shared() -> None:
    by_variable = {s.variable: s.polynomial for s in replace_functions(exponentials(HIGH, 0.9 * HIGH, 2 * HIGH))[1]}
    assert by_variable.keys() == {"a0, a1", "a2"}
    assert by_variable["a0, a1"].high == HIGH and by_variable["a2"].high == 2 * HIGH
    assert by_variable["a0, a1"].degree < by_variable["a2"].degree


def equally_named_functions() -> Block:
    """Return two Blocks, each with a function called `gain`."""

    def block(name: str, output: str, source: str, f: Callable[[ca.SX], ca.SX]) -> Block:
        return make(
            lambda u, k: Step({output: 2 * f(u[source])}, named=[(signal("gain"), f(u[source]))]), output, name, source
        )

    blocks = [block("one", "p", "a", ca.exp), block("two", "q", "b", ca.cosh)]
    return compose("both", blocks, inputs=["a", "b"], outputs=["p", "q"])


def test_signals_of_equal_names_get_separate_polynomials() -> None:
    _, surrogates = replace_functions(equally_named_functions())
    assert [s.name for s in surrogates] == ["gain_polynomial", "gain_2_polynomial"]
    made = emit(equally_named_functions(), F32, error=COARSE)
    controller = host.load(made.files, made.manifest)
    out = controller.step(controller.init(), {"a": 0.5, "b": 0.25}).outputs
    np.testing.assert_allclose([out["p"], out["q"]], [2 * np.exp(0.5), 2 * np.cosh(0.25)], rtol=2 * COARSE)


def shifted_reciprocal() -> Block:
    """Return a function with a pole below the range, beside a reciprocal with the same pole."""
    return make(lambda u, k: {"y": ca.exp(0.5 / (u["a"] + 0.125)) + 1, "z": 3 / (u["a"] + 0.125)}, "y z", inputs="a")


def test_an_existing_reciprocal_becomes_the_variable() -> None:
    program, (surrogate,) = replace_functions(shifted_reciprocal())
    assert surrogate.variable == "1 / (a + 0.125)"
    assert [n.op for n in program.nodes if n.op in ("div", "inv")] == ["inv"]
    alone = make(lambda u, k: {"y": ca.exp(0.5 / (u["a"] + 0.125)) + 1}, inputs="a")
    _, (other,) = replace_functions(alone)
    assert other.variable == "a" and surrogate.polynomial.degree < other.polynomial.degree


# --- certificates on the emitted C ---


def draws(low: float, high: float, scalar: type[np.floating], count: int = 3000) -> np.ndarray:
    inside = np.random.default_rng(7).uniform(low, high, count).astype(scalar)
    return np.unique(np.clip(np.append(inside, np.array([low, high], scalar)), scalar(low), scalar(high)))


def error(made: EmittedCode, f: Callable[[Any], Any], scalar: type[np.floating]) -> float:
    """Return the largest relative error of output y as a function f of input a, over random inputs."""
    controller = host.load(made.files, made.manifest)
    x = draws(LOW, HIGH, scalar)
    inputs: dict[str, Any] = {"a": x} | ({"b": 0.25} if "b" in (controller.inputs.names or ()) else {})
    y = controller.replay(inputs).outputs["y"]
    with mpmath.workprec(120):
        truth = [f(mpmath.mpf(float(v))) for v in x]
        return float(max(abs(mpmath.mpf(float(v)) / t - 1) for v, t in zip(y, truth, strict=True)))


CASES: dict[str, tuple[Callable[[Any], ca.SX], Callable[[Any], Any]]] = {
    "exp": (ca.exp, mpmath.exp),
    "sine of a multiple": (lambda a: ca.sin(3 * a), lambda a: mpmath.sin(3 * a)),
    "quotient": (lambda a: ca.tanh(a) / (1 + a * a), lambda a: mpmath.tanh(a) / (1 + a * a)),
    "root": (lambda a: ca.sqrt(1 + ca.log(1 + a)), lambda a: mpmath.sqrt(1 + mpmath.log(1 + a))),
}


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize(("scalar", "allowed"), [(F32, COARSE), (F32, None), (F64, None)])
def test_the_c_keeps_its_certificate(name: str, scalar: type[np.floating], allowed: float | None) -> None:
    law, f = CASES[name]
    made = emit(make(lambda u, k: {"y": law(u["a"])}, inputs="a"), scalar, error=allowed)
    (surrogate,) = made.manifest["surrogates"]
    promised = surrogate["max_relative_error"]
    assert promised <= (allowed or {F32: 2e-7, F64: 1e-14}[scalar])
    assert error(made, f, scalar) <= promised
    # It is no idle promise: what is found comes near to it.
    assert error(made, f, scalar) > promised / 50


def test_the_c_keeps_the_certificate_of_a_reciprocal() -> None:
    """The certificate holds for the function of the rounded reciprocal that the C computes."""
    made = emit(shifted_reciprocal(), F32, error=COARSE)
    (surrogate,) = made.manifest["surrogates"]
    controller = host.load(made.files, made.manifest)
    x = draws(LOW, HIGH, F32)
    u = F32(1) / (x + F32(0.125))
    y = controller.replay({"a": x}).outputs["y"]
    with mpmath.workprec(120):
        truth = [mpmath.exp(mpmath.mpf(float(v)) / 2) + 1 for v in u]
        worst = max(abs(mpmath.mpf(float(v)) / t - 1) for v, t in zip(y, truth, strict=True))
    assert surrogate["max_relative_error"] / 50 < worst <= surrogate["max_relative_error"]


def test_a_changed_coefficient_breaks_the_certificate() -> None:
    made = emit(make(lambda u, k: {"y": ca.exp(u["a"])}, inputs="a"), F32, error=COARSE)
    (surrogate,) = made.manifest["surrogates"]
    body = re.search(r"return (\S+f) \+", made.files["made.c"])
    assert body
    wrong = f"{float(body[1][:-1]) * (1 + 3 * surrogate['max_relative_error']):.9g}f"
    files = {**made.files, "made.c": made.files["made.c"].replace(body[1], wrong)}
    assert wrong != body[1]
    assert error(EmittedCode(files, made.manifest), mpmath.exp, F32) > surrogate["max_relative_error"]


@pytest.mark.parametrize("scalar", [F32, F64])
def test_libm_may_be_kept(scalar: type[np.floating]) -> None:
    made = emit(make(lambda u, k: {"y": ca.exp(u["a"]) * ca.tanh(u["b"])}), scalar, libm=True)
    suffix = "f" if scalar is F32 else ""
    assert f"exp{suffix}(a)" in made.files["made.c"] and f"tanh{suffix}(b)" in made.files["made.c"]
    assert "polynomial" not in made.files["made.c"] and made.manifest["surrogates"] == []
    tanh = float(np.tanh(0.25))
    assert error(made, lambda a: mpmath.exp(a) * tanh, scalar) < tolerances.of("libm_ulps") * np.finfo(scalar).eps


def test_programs_keep_their_values() -> None:
    """Replacement changes only the values of the functions that it replaces."""
    block = make(lambda u, k: {"y": ca.exp(u["a"]) * 3, "z": u["a"] / (u["b"] + 1)}, "y z")
    program, _ = replace_functions(block)
    plain = fold.folded(lower.program(block))
    ops = [sorted(n.op for n in p.nodes if n.op in ("div", "input")) for p in (program, plain)]
    assert ops[0] == ops[1] and list(program.outputs) == ["y", "z"] and len(program.marks) == len(plain.marks)
