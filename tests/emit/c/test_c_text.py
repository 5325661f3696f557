"""The text of the C: every operation, every literal and every name, against CasADi's own evaluation of the Block.

Random trees of dyadic arithmetic are equal to the last bit, so that a lost parenthesis shows; functions of libm are
equal to rounding.
"""

import re
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.emit.approx.polynomial import Polynomial
from synth.emit.c import c_text, routines
from synth.emit.c.expressions import Text, literal
from synth.emit.passes import fold
from synth.emit.passes.surrogates import Surrogate
from synth.emit.program import lower, operations
from synth.emit.program.layout import layout
from synth.emit.write import EmittedCode, emit
from synth.errors import CompileError, EmitError
from synth.execute import compile as compiler
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete
from tests import tolerances, tools
from tests.emit import dyadic, one_step
from tests.emit.c.test_header import NAMES, committed
from tests.emit.dyadic import TIME, Value, choose, combine, signal

pytestmark = pytest.mark.slow

F32, F64 = np.float32, np.float64
SX = ca.SX
# Arguments are kept where the operation is proved safe, by operations that are under test as well.
UNARY: list[Callable[[SX], SX]] = [
    lambda a: -a,
    lambda a: ca.exp(ca.tanh(a)),
    lambda a: ca.log(1 + a**2),
    lambda a: ca.sqrt(ca.fabs(a)),
    lambda a: a**2 - 0.5,
    lambda a: 2 * a,
    ca.sin,
    ca.cos,
    lambda a: ca.tan(ca.atan(a) / 2),
    lambda a: ca.asin(ca.tanh(a) / 2),
    lambda a: ca.acos(ca.sin(a) / 2),
    ca.atan,
    lambda a: ca.sinh(ca.sin(a)),
    lambda a: ca.cosh(ca.cos(a)),
    ca.tanh,
    ca.fabs,
    lambda a: ca.floor(3 * ca.fabs(a)),
    lambda a: 1 / (a**2 + 0.25),
    ca.logic_not,
    lambda a: ca.expm1(ca.tanh(a)),
    lambda a: ca.log1p(ca.fabs(a)),
    ca.asinh,
    ca.erf,
    ca.sign,
    ca.floor,
    ca.ceil,
    lambda a: ca.fabs(a) ** 2.5,
    lambda a: (1 + a**2) ** -1.5,
    lambda a: (1 + a**2) ** (1 / 3),
]
BINARY: list[Callable[[SX, SX], SX]] = [
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / (1 + b**2),
    ca.fmin,
    ca.fmax,
    lambda a, b: ca.fmax(ca.fmin(a, 2), -2) * b,
    lambda a, b: ca.atan2(a, 1 + b**2),
    lambda a, b: a < b,
    lambda a, b: a <= b,
    lambda a, b: a == b,
    lambda a, b: a != b,
    ca.logic_and,
    ca.logic_or,
    lambda a, b: ca.if_else(a, b, 0),
    lambda a, b: ca.fmod(a, 1 + b**2),
    lambda a, b: ca.remainder(a, 1 + b**2),
    ca.copysign,
    ca.hypot,
    lambda a, b: (1 + a**2) ** ca.sin(b),
    lambda a, b: ca.if_else(a < b, ca.sin(a), ca.cos(b)),
]
INPUTS = [signal(n, -4, 4) for n in "abc"]


@cache
def single_operations() -> Block:
    """Return a Block with one output for each operation, applied to inputs directly."""

    def law(u: Any, x: Any, k: Any) -> Step:
        made = [f(u["a"]) for f in UNARY] + [f(u["a"], u["b"]) for f in BINARY]
        return Step({f"y{i}": e for i, e in enumerate(made)})

    outputs = [signal(f"y{i}") for i in range(len(UNARY) + len(BINARY))]
    return build("single", TIME, law, inputs=INPUTS, outputs=outputs)


def tree(rng: np.random.Generator, leaves: list[Value], depth: int) -> Value:
    """Return a random expression of nested operations."""
    if depth == 0:
        return leaves[rng.integers(len(leaves))]
    a, b = (tree(rng, leaves, int(d)) for d in rng.permutation([depth - 1, int(rng.integers(depth))]))
    compared = [a.e < b.e, a.e <= b.e, a.e == b.e, a.e != b.e, ca.logic_and(a.e, b.e), ca.logic_or(a.e, b.e)]
    kind = int(rng.integers(20))
    if kind < 6:
        return Value(compared[kind], 1, 0)
    made = [choose(compared[int(rng.integers(6))], a, b), Value(ca.logic_not(a.e), 1, 0)]
    value = made[kind - 6] if kind < 8 else combine((kind - 8) % 9, a, b, b.e)
    return value if value.exact() else a


@cache
def trees(count: int = 80) -> Block:
    rng = np.random.default_rng(3)

    def law(u: Any, x: Any, k: Any) -> Step:
        leaves = [Value(u[s.name], 4, 2) for s in INPUTS] + [Value(e, 2, 2) for e in k.values()]
        leaves += [Value(SX(v), abs(v), 2) for v in (0.75, -3.0, 1.0)]
        return Step({f"y{i}": tree(rng, leaves, 5).e for i in range(count)})

    constants = [Constant("k", 0.25, "1", "test"), Constant("minus", -1.75, "1", "test")]
    outputs = [signal(f"y{i}") for i in range(count)]
    return build("trees", TIME, law, inputs=INPUTS, outputs=outputs, constants=constants)


@cache
def memory() -> Block:
    """Return a Block with integer states that count, gate and choose, and clamped real ones."""

    def law(u: Any, x: Any, k: Any) -> Step:
        over = ca.logic_or(x["over"], ca.logic_and(u["a"] > 1, x["count"] >= 2))
        count = ca.if_else(u["a"] < u["b"], ca.fmin(x["count"] + 1, 5), 0)
        total = x["total"] + ca.if_else(over, 0.375 * u["c"], x["count"] * u["a"])
        return Step(
            {"y": total, "flag": over, "phase": x["previous"]},
            {"count": count, "over": over, "previous": x["count"], "total": total, "last": x["total"]},
        )

    whole = [State(signal(n, 0, 5), 0, True) for n in ("count", "over", "previous")]
    states = [whole[0], State(signal("total", -1.5, 2), 0.25), *whole[1:], State(signal("last", -4, 4), -1)]
    outputs = [signal(n) for n in ("y", "flag", "phase")]
    return build("memory", TIME, law, inputs=INPUTS, outputs=outputs, states=states)


BLOCKS = {"single": single_operations, "trees": trees, "memory": memory}


@cache
def emit_cached(block: Block, scalar: type[np.floating]) -> EmittedCode:
    """Emit a Block, the same object, once; a test that plants a defect in the emitter gives an object of its own."""
    return emit(block, scalar, libm=True)


def c_files(block: Block, scalar: type[np.floating]) -> dict[str, str]:
    return host.code(emit_cached(block, scalar).files)


def differences(
    block: Block, scalar: type[np.floating], change: Callable[[str], str] = str, rtol: float = 0.0
) -> list[str]:
    """Return the names of the results in which the changed C differs from CasADi."""
    emitted, (x, u) = emit_cached(block, scalar), dyadic.samples(block, 800)
    library = one_step.compile_together([emitted], change)
    return one_step.by_c(library, block, emitted, x, u).differences(one_step.by_casadi(block, x, u), rtol)


@pytest.mark.parametrize("scalar", [F32, F64])
@pytest.mark.parametrize("name", ["trees", "memory"])
def test_dyadic_arithmetic_equals_casadi_to_the_last_bit(name: str, scalar: type[np.floating]) -> None:
    assert not differences(BLOCKS[name](), scalar)


def test_operations_equal_casadi_to_rounding() -> None:
    assert not differences(single_operations(), F64, rtol=tolerances.of("folded"))
    # The few roundings between an input and an output, and libm's, in units of single precision.
    assert not differences(single_operations(), F32, rtol=16 * 2.0**-24)


def test_a_replay_from_init_equals_casadi() -> None:
    block, emitted = memory(), emit_cached(memory(), F32)
    controller, (_, u) = host.load(emitted.files, emitted.manifest), dyadic.samples(block, 1500)
    replay = controller.replay(dict(zip("abc", u, strict=True)))
    f, x, rows = block.function(), block.initial, []
    for sample in u.T:
        next, y = f(x, sample)
        x = next.full().ravel()
        rows.append(y.full().ravel())
    np.testing.assert_array_equal(np.array([replay.outputs[s.name] for s in block.outputs]).T, rows)
    np.testing.assert_array_equal([replay.state[s.name] for s in block.states], x)
    assert set(replay.outputs["phase"]) == {0, 1, 2, 3, 4, 5} and set(replay.outputs["flag"]) == {0, 1}


def test_every_operation_is_tested() -> None:
    tried = {n.op for make in BLOCKS.values() for n in fold.folded(lower.program(make())).nodes}
    assert tried >= {*operations.UNARY.values(), *operations.BINARY.values(), "choose", "clamp"} - {"twice", "when"}
    assert tried >= operations.LIBM


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("memory", "a < b", "a <= b"),
        ("memory", "5.0", "4.0"),
        ("memory", "= state->count", "= 0u * state->count"),
        ("memory", "state->count = ", "state->count = 1u + "),
        ("single", "(a < b) ? a : b", "(a < b) ? b : a"),
        ("single", "? -high : ", "? high : "),
        ("trees", "k = 0.25", "k = 0.25000000000000006"),
    ],
)
def test_a_planted_change_of_the_c_is_detected(name: str, old: str, new: str) -> None:
    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new)

    assert differences(BLOCKS[name](), F64, change, tolerances.of("folded") if name == "single" else 0.0)


def test_a_missing_parenthesis_is_detected() -> None:
    block = trees()
    emitted = re.sub(r"(?<![;{}/])\n {5,}", " ", c_files(block, F64)["trees.c"])  # each statement on one line
    code = re.sub(r"/\*.*?\*/", lambda comment: " " * len(comment[0]), emitted, flags=re.S)
    places = list(re.finditer(r"(?<=[-*] )\((\w+ [-+] [\w.]+)\)", code))[:6]
    mutants = [emitted[: m.start()] + m[1] + emitted[m.end() :] for m in places]
    seen = [bool(differences(block, F64, lambda text, mutant=mutant: mutant)) for mutant in mutants]
    # A tree may mask the value of a subtree: (x || y) is the same for 3 and 5.
    assert len(seen) == 6 and sum(seen) >= 4


@pytest.mark.parametrize("name", ["inside", "beside"])
def test_parentheses_that_are_never_written_are_detected(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Text, name, lambda self, strength: self.c)
    # A comparison of a comparison is an error to clang, which -w leaves one.
    monkeypatch.setattr(compiler, "STRICT_FLAGS", ("-std=c99", "-w", "-Wno-parentheses"))
    assert differences(replace(trees()), F64)


@pytest.mark.parametrize("command", tools.HOST_COMPILERS)
@pytest.mark.parametrize("scalar", [F32, F64])
@pytest.mark.parametrize("name", BLOCKS)
def test_no_warning(name: str, scalar: type[np.floating], command: str) -> None:
    compiler.check(c_files(BLOCKS[name](), scalar), compiler=tools.host_compiler(command))


def test_a_planted_warning_is_detected() -> None:
    files = c_files(memory(), F32)
    assert "0.375f" in files["memory.c"]
    with pytest.raises(CompileError, match="double"):
        compiler.check(files | {"memory.c": files["memory.c"].replace("0.375f", "0.375")})


DOUBLE_CALL = re.compile(rf"\b(?:{'|'.join(sorted(operations.LIBM))}|fmin|fmax|pow)\s*\(|\bdouble\b")
DOUBLE_LITERAL = re.compile(r"(?<![\w.])(?:\d+\.\d*|\.\d+|\d+(?=e))(?:e[-+]?\d+)?(?![\w.])")


def doubles(text: str) -> list[str]:
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    return DOUBLE_CALL.findall(code) + DOUBLE_LITERAL.findall(code)


def test_single_precision_code_contains_no_double() -> None:
    blocks = [make() for make in BLOCKS.values()] + [dyadic.random_block(seed) for seed in (0, 3)]
    for block in blocks:
        for text in c_files(block, F32).values():
            assert not doubles(text)
    block = build(
        "brief",
        TIME,
        lambda u, x, k: Step({"y": ca.exp(u["a"])}),
        inputs=[signal("a", 0.25, 0.5)],
        outputs=[signal("y")],
    )
    text = emit(block, F32, error=1e-5).files["brief.c"]
    assert "y_polynomial" in text and not doubles(text)


@pytest.mark.parametrize("line", ["y = 0.3 * a;", "y = 1e-5;", "y = a + 1.;", "y = sin(a);", "const double y = a;"])
def test_a_planted_double_is_found(line: str) -> None:
    assert doubles(line) and not doubles(f"/* {line} */ y = sinf(0.3f) + 1e-05f;")


@pytest.mark.parametrize("scalar", [F32, F64])
def test_literals_read_back_exactly(scalar: type[np.floating]) -> None:
    rng = np.random.default_rng(5)
    edges = [0.0, -0.0, 1.0, -1.0, 2.0**24, 1e-30, np.finfo(scalar).max, np.finfo(scalar).smallest_subnormal]
    values = np.array([*edges, *(rng.normal(size=200) * 10.0 ** rng.integers(-30, 30, 200))])
    rows = ", ".join(literal(v, scalar).c for v in values)
    c = "float" if scalar is F32 else "double"
    table = f"{c} table[] = {{{rows}}};\nint count(void) {{ return (int)(sizeof table / sizeof table[0]); }}\n"
    library = host.ctypes.CDLL(str(compiler.shared_library({"table.c": table})))
    element = host.ctypes.c_float if scalar is F32 else host.ctypes.c_double
    compiled = np.array((element * library.count()).in_dll(library, "table"), dtype=scalar)
    np.testing.assert_array_equal(compiled.view(np.uint8), values.astype(scalar).view(np.uint8))


@pytest.mark.parametrize(("value", "scalar"), [(np.nan, F64), (np.inf, F32), (1e39, F32)])
def test_a_number_that_is_not_finite_is_refused(value: float, scalar: type[np.floating]) -> None:
    with pytest.raises(EmitError, match="not finite in"):
        literal(value, scalar)


@pytest.mark.parametrize(
    "name",
    ["sin", "sinf", "y1", "gamma", "state", "in", "out", "faults", "min", "limit", "k", "t2", "main", "uint32_t"],
)
def test_a_signal_may_share_a_name_of_the_c(name: str) -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        y = ca.sin(u[name]) * ca.fmin(u[name], 2) + ca.fmax(ca.fmin(u[name] * 2, 3), -3) + k["unused"]
        return Step({"y": y}, {"n": ca.fmin(x["n"] + 1, 7)})

    block = build(
        "shared",
        TIME,
        law,
        inputs=[signal(name, -4, 4)],
        outputs=[signal("y")],
        states=[State(signal("n", 0, 7), 0, True)],
        constants=[Constant("unused", 0.5, "1", "text that /* opens and */ closes"), Constant("idle", 1, "1", "test")],
    )
    assert not differences(block, F32, rtol=2.0**-20)


@pytest.mark.parametrize("scalar", [F32, F64])
def test_a_block_that_reads_no_input_or_keeps_no_state_compiles_clean(scalar: type[np.floating]) -> None:
    still = build("still", TIME, lambda u, x, k: Step({"y": 0.25}), inputs=[signal("a")], outputs=[signal("y")])
    files = c_files(still, scalar)
    compiler.check(files)
    assert "(void)in;" in files["still.c"] and "(void)state;" in files["still.c"]
    controller = host.load(files, emit_cached(still, scalar).manifest)
    assert controller.step(controller.init(), {"a": 1.0}).outputs == {"y": 0.25}


def test_comments_carry_tag_unit_range_and_cannot_be_closed_early() -> None:
    a = replace(signal("a", -2, 3), unit="kg m/s^2", about="a */ force")
    block = build(
        "tagged", TIME, lambda u, x, k: Step({"y": 3 * u["a"]}), inputs=[a], outputs=[signal("y")], tag="flag(12) /*"
    )
    files = c_files(block, F32)
    assert "/* tagged: flag(12) / * */\n" in files["tagged.c"] and "uint32_t flag(" not in files["tagged.c"]
    assert "/* kg m/s^2, -2 .. 3: a * / force */" in files["tagged.h"]
    compiler.check(files)


def test_unused_helpers_are_not_printed() -> None:
    text = c_files(memory(), F64)["memory.c"]
    assert "double memory_min(" in text and "memory_limit(" not in text and "math.h" not in text


def test_a_polynomial_is_printed_by_horner_without_zero_terms() -> None:
    memory_ = layout(memory(), F32)
    for coefficients in ((0.5,), (1.0, -2.0), (0.0, 2.0), (1.5, 0.0, 0.0, -0.25), (0.0, 0.0, 1.0)):
        p = Polynomial(-1, 1, 0.0, 1.0, "none", coefficients, F32, 1e-7)
        lines = c_text._polynomial(Surrogate("p", ("y",), "x", p), memory_)
        (text,) = (line.strip()[len("return ") : -1] for line in lines if "return" in line)
        assert text.count("+") == sum(c != 0 for c in coefficients[:-1])
        for t in (-0.75, 0.0, 0.5):
            assert float(eval(text.replace("f", ""), {"t": t})) == float(p.evaluate(t))


@pytest.mark.parametrize("scalar", [F32, F64])
def test_real_numbers_are_compared_without_the_operator_that_compilers_warn_about(scalar: type[np.floating]) -> None:
    """The comparisons agree with == and != for NaN, infinities and zeros of both signs; truth values need no choice."""
    signals = [Signal(n, "1", -9, 9) for n in "ab"]
    block = build(
        "comparison",
        Discrete(1e-3),
        lambda u, x, k: Step({"same": u["a"] == u["b"], "other": u["a"] != u["b"], "set": ca.if_else(u["a"], 1, 0)}),
        inputs=signals,
        outputs=[Signal(n, "1", 0, 1) for n in ("same", "other", "set")],
    )
    made = emit(block, scalar)
    assert "? true" not in made.files["comparison.c"] and "comparison_equal(a, b)" in made.files["comparison.c"]
    values = np.array([0.0, -0.0, 1.0, np.inf, -np.inf, np.nan, 1e-30], scalar)
    a, b = (m.ravel() for m in np.meshgrid(values, values))
    outputs = host.load(made.files, made.manifest).replay({"a": a, "b": b}).outputs
    for name, expected in {"same": a == b, "other": a != b, "set": a != 0}.items():
        np.testing.assert_array_equal(outputs[name], expected)


def test_the_end_of_a_comment_stands_beside_its_last_word() -> None:
    """Whatever its length: a line with the end alone says nothing."""
    for n in range(90, 130):
        rows = routines.comment("a " * (n // 2) + "b")
        assert rows[-1].strip() != "* */" and all(len(row) <= 120 for row in rows)


@pytest.mark.parametrize("name", NAMES)
def test_the_step_and_the_law_are_short_functions(name: str) -> None:
    """The step has at most 120 lines and reads like the block diagram, any other function at most 150.

    The tables of parameters stand in the one function that reads them (MISRA C:2012, 8.9), and are not counted.
    """
    text = re.sub(r"\n    static const \w+_parameters_t [^;]*;", "", committed(name)[f"{name}.c"])
    lines = text.splitlines()
    sizes: dict[str, int] = {}
    for begin in (k for k, line in enumerate(lines) if line == "{"):
        head = next(k for k in range(begin - 1, -1, -1) if not lines[k].startswith(" "))
        called = re.search(rf"{name}_(\w+)\(", "".join(lines[head:begin]))
        sizes[called[1] if called else lines[head]] = lines.index("}", begin) - head + 1
    assert sizes.get("body", sizes["step"]) <= 120
    assert {function: size for function, size in sizes.items() if size > 150} == {}
