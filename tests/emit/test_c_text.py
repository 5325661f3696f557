"""The printed C against CasADi's own evaluation of the same Block, to rounding; counters and flags exactly.

Random expressions try every operation inside every other, so that a lost parenthesis shows.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.emit import c_text, fold, layout, lower, manifest, write
from synth.emit.printer import literal
from synth.errors import CompileError, EmitError
from synth.execute import compile as compiler
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
SX = ca.SX
# Arguments are kept where the operation is finite and smooth, by operations that are under test as well.
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
    lambda a: 1 / (a**2 + 0.25),
    ca.logic_not,
]
BINARY: list[Callable[[SX, SX], SX]] = [
    lambda a, b: a + b,
    lambda a, b: a - b,
    lambda a, b: a * b,
    lambda a, b: a / (1 + b**2),
    ca.fmin,
    ca.fmax,
    ca.atan2,
    lambda a, b: a < b,
    lambda a, b: a <= b,
    lambda a, b: a == b,
    lambda a, b: a != b,
    ca.logic_and,
    ca.logic_or,
    lambda a, b: ca.if_else(a, b, 0),
    lambda a, b: ca.if_else(a < b, ca.sin(a), ca.cos(b)),
]
INPUTS = ("a", "b", "c")


def signal(name: str, low: float = -10, high: float = 10) -> Signal:
    return Signal(name, "1", low, high)


def random_expression(rng: np.random.Generator, leaves: list[SX], depth: int) -> SX:
    if depth == 0:
        return leaves[rng.integers(len(leaves))]
    if rng.random() < 0.4:
        return UNARY[rng.integers(len(UNARY))](random_expression(rng, leaves, depth - 1))
    sides = [random_expression(rng, leaves, d) for d in rng.permutation([depth - 1, int(rng.integers(depth))])]
    return BINARY[rng.integers(len(BINARY))](sides[0], sides[1])


def single_operations() -> Block:
    """One output for each operation, applied to inputs directly."""

    def law(u: Any, x: Any, k: Any) -> Step:
        made = [f(u["a"]) for f in UNARY] + [f(u["a"], u["b"]) for f in BINARY]
        return Step({f"y{i}": e for i, e in enumerate(made)})

    count = len(UNARY) + len(BINARY)
    return build(
        "single", TIME, law, inputs=[signal(n) for n in INPUTS], outputs=[signal(f"y{i}") for i in range(count)]
    )


def random_trees(count: int = 120) -> Block:
    rng = np.random.default_rng(3)

    def law(u: Any, x: Any, k: Any) -> Step:
        leaves = [*u.values(), *k.values(), SX(0.75), SX(-3.0), SX(1e-3)]
        return Step({f"y{i}": random_expression(rng, leaves, 5) for i in range(count)})

    return build(
        "trees",
        TIME,
        law,
        inputs=[signal(n) for n in INPUTS],
        outputs=[signal(f"y{i}") for i in range(count)],
        constants=[Constant("k", 0.3, "1", "test"), Constant("minus", -1.7, "1", "test")],
    )


def memory() -> Block:
    """Integer states that count, gate and choose, beside clamped real ones."""

    def law(u: Any, x: Any, k: Any) -> Step:
        over = ca.logic_or(x["over"], ca.logic_and(u["a"] > 1, x["count"] >= 2))
        count = ca.if_else(u["a"] < u["b"], ca.fmin(x["count"] + 1, 5), 0)
        total = x["total"] + ca.if_else(over, 0.3 * u["c"], x["count"] * u["a"])
        return Step(
            {"y": total, "flag": over, "phase": x["previous"]},
            {"count": count, "over": over, "previous": x["count"], "total": total, "last": x["total"]},
        )

    whole = [State(signal(n, 0, 5), 0, True) for n in ("count", "over", "previous")]
    states = [whole[0], State(signal("total", -1.5, 2), 0.25), *whole[1:], State(signal("last"), -1)]
    names = ("y", "flag", "phase")
    return build(
        "memory", TIME, law, inputs=[signal(n) for n in INPUTS], outputs=[signal(n) for n in names], states=states
    )


def samples(count: int = 1500) -> np.ndarray:
    """Inputs that often meet each other and the literals, and others; all are exact in single precision."""
    rng = np.random.default_rng(4)
    grid, line = rng.integers(-4, 5, (3, count)) / 4, rng.uniform(-3, 3, (3, count))
    return np.where(rng.random((3, count)) < 0.5, grid, line).astype(np.float32).astype(np.float64)


def printed(block: Block, scalar: type[np.floating]) -> write.Emitted:
    """Print a Block without the proofs and the surrogates of emission: these Blocks try what those would refuse."""
    shipped = block.rounded(scalar)
    memory_ = layout.layout(shipped, scalar)
    program = fold.folded(lower.program(shipped))
    by_name = {c.name: c.value for c in shipped.constants}
    products = [
        Constant(name, float(scalar(by_name[a] * by_name[b])), "1", "") for name, (a, b) in program.products.items()
    ]
    shipped = replace(shipped, constants=(*shipped.constants, *products))
    lines = c_text.source(shipped, program, (), memory_)
    texts = {
        f"{block.name}.c": "".join(f"{line.text}\n" for line in lines),
        f"{block.name}.h": c_text.header(shipped, memory_),
    }
    return write.Emitted(texts, manifest.manifest(shipped, memory_, None, texts, (), lines))


def c_files(block: Block, scalar: type[np.floating]) -> dict[str, str]:
    return dict(printed(block, scalar).files)


def load(block: Block, scalar: type[np.floating], change: Callable[[str], str] = str) -> host.Controller:
    found = printed(block, scalar)
    files = {n: change(t) if n.endswith(".c") else t for n, t in found.files.items()}
    # A compiler that folds sin(0.5) rounds correctly, while libm may be one unit off.
    return host.load(files, found.manifest, ["-fno-builtin"])


def casadi_rows(block: Block, u: np.ndarray) -> dict[str, np.ndarray]:
    """Step CasADi's function from the initial state; real arithmetic throughout, also for the integer states."""
    f, x, rows = block.function(), block.initial, []
    for sample in u.T:
        next, y = f(x, sample)
        x = next.full().ravel()
        rows.append(np.concatenate([y.full().ravel(), x]))
    names = [s.name for s in block.outputs] + [f"next {s.name}" for s in block.states]
    return dict(zip(names, np.array(rows).T, strict=True))


def c_rows(controller: host.Controller, u: np.ndarray) -> Mapping[str, np.ndarray]:
    return controller.replay(dict(zip(INPUTS, u, strict=True))).outputs


def unlike(found: Mapping[str, np.ndarray], expected: Mapping[str, np.ndarray]) -> list[str]:
    """Name the signals that differ by more than rounding in more than one sample of 100.

    Folding moves last bits; where two of them meet in a comparison, a sample may go the other way.
    """
    return [n for n in found if np.mean(~np.isclose(found[n], expected[n], rtol=1e-9, atol=1e-12)) > 0.01]


BLOCKS = {"single": single_operations, "trees": random_trees, "memory": memory}


@pytest.mark.parametrize("name", BLOCKS)
def test_double_equals_casadi_to_rounding(name: str) -> None:
    block, u = BLOCKS[name](), samples()
    expected = casadi_rows(block, u)
    assert np.isfinite(list(expected.values())).all()
    assert not unlike(c_rows(load(block, np.float64), u), expected)


def test_the_state_after_replay_equals_casadi() -> None:
    block, u = memory(), samples()
    expected = casadi_rows(block, u)
    state = load(block, np.float64).replay(dict(zip(INPUTS, u, strict=True))).state
    assert {n: state[n] for n in state.dtype.names if n != "reserved"} == {
        s.name: expected[f"next {s.name}"][-1] for s in block.states
    }
    assert len(set(expected["next count"])) == 6 and set(expected["flag"]) == {0, 1}


def test_every_operation_is_tried() -> None:
    tried = {n.op for make in BLOCKS.values() for n in fold.folded(lower.program(make())).nodes}
    assert tried >= {*lower.UNARY.values(), *lower.BINARY.values(), "choose"} - {"twice", "when"}


def test_single_precision_equals_casadi_to_rounding() -> None:
    block, u = single_operations(), samples()
    expected, found = casadi_rows(block, u), c_rows(load(block, np.float32), u)
    for name, values in found.items():
        assert values.dtype == np.float32
        # At most four roundings stand between an input and an output; absolute below 1, where differences cancel.
        bound = 8 * 2.0**-24 * np.maximum(1, np.abs(expected[name]))
        assert (np.abs(values - expected[name]) <= bound).all(), name


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("memory", "a < b", "a <= b"),
        ("memory", "5.0", "4.0"),
        ("memory", "= state->count", "= 0u * state->count"),
        ("single", "(a < b) ? a : b", "(a < b) ? b : a"),
        ("trees", "k = 0.3", "k = 0.3000001"),
    ],
)
def test_a_planted_change_of_the_c_is_seen(name: str, old: str, new: str) -> None:
    block, u = BLOCKS[name](), samples()

    def change(text: str) -> str:
        assert old in text
        return text.replace(old, new)

    assert unlike(c_rows(load(block, np.float64, change), u), casadi_rows(block, u))


def test_a_lost_parenthesis_is_seen() -> None:
    block, u = random_trees(), samples()
    emitted = c_files(block, np.float64)["trees.c"]
    places = list(re.finditer(r"(?<=[*/] )\((\w+ [-+] [\w.]+)\)", emitted))
    assert places
    for match in places[:3]:
        mutant = emitted[: match.start()] + match[1] + emitted[match.end() :]
        found = c_rows(load(block, np.float64, lambda text, mutant=mutant: mutant), u)
        assert unlike(found, casadi_rows(block, u))


def gcc() -> compiler.Compiler:
    return compiler.find_compiler()


def zig() -> compiler.Compiler | None:
    pytest.importorskip("ziglang", reason="the ziglang wheel is not installed")
    return compiler.zig_compiler()


@pytest.mark.parametrize("find", [gcc, zig])
@pytest.mark.parametrize("scalar", [np.float32, np.float64])
@pytest.mark.parametrize("name", BLOCKS)
def test_no_warning(name: str, scalar: type[np.floating], find: Callable[[], compiler.Compiler | None]) -> None:
    compiler.check(c_files(BLOCKS[name](), scalar), compiler=find())


def test_a_planted_warning_is_seen() -> None:
    files = c_files(memory(), np.float32)
    with pytest.raises(CompileError, match="double"):
        compiler.check(files | {"memory.c": files["memory.c"].replace("0.3f", "0.3")})


DOUBLE_CALL = re.compile(
    r"\b(?:exp|log|sqrt|sin|cos|tan|asin|acos|atan|sinh|cosh|tanh|fabs|atan2|fmin|fmax|pow)\s*\(|\bdouble\b"
)
DOUBLE_LITERAL = re.compile(r"(?<![\w.])(?:\d+\.\d*|\.\d+|\d+(?=e))(?:e[-+]?\d+)?(?![\w.])")


def doubles(text: str) -> list[str]:
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.S)
    return DOUBLE_CALL.findall(code) + DOUBLE_LITERAL.findall(code)


@pytest.mark.parametrize("name", BLOCKS)
def test_single_precision_holds_nothing_double(name: str) -> None:
    for text in c_files(BLOCKS[name](), np.float32).values():
        assert not doubles(text)


@pytest.mark.parametrize("line", ["y = 0.3 * a;", "y = 1e-5;", "y = a + 1.;", "y = sin(a);", "const double y = a;"])
def test_a_planted_double_is_found(line: str) -> None:
    assert doubles(line) and not doubles(f"/* {line} */ y = sinf(0.3f) + 1e-05f;")


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_literals_read_back_exactly(scalar: type[np.floating]) -> None:
    rng = np.random.default_rng(5)
    edges = [0.0, -0.0, 1.0, -1.0, 2.0**24, 1e-30, np.finfo(scalar).max, np.finfo(scalar).smallest_subnormal]
    values = np.array([*edges, *(rng.normal(size=200) * 10.0 ** rng.integers(-30, 30, 200))])
    rows = ", ".join(literal(v, scalar).c for v in values)
    c = "float" if scalar is np.float32 else "double"
    table = f"{c} table[] = {{{rows}}};\nint count(void) {{ return (int)(sizeof table / sizeof table[0]); }}\n"
    library = host.ctypes.CDLL(str(compiler.shared_library({"table.c": table})))
    element = host.ctypes.c_float if scalar is np.float32 else host.ctypes.c_double
    found = np.array((element * library.count()).in_dll(library, "table"), dtype=scalar)
    np.testing.assert_array_equal(found.view(np.uint8), values.astype(scalar).view(np.uint8))


@pytest.mark.parametrize(("value", "scalar"), [(np.nan, np.float64), (np.inf, np.float32), (1e39, np.float32)])
def test_a_number_that_is_not_finite_is_refused(value: float, scalar: type[np.floating]) -> None:
    with pytest.raises(EmitError, match="not finite in"):
        literal(value, scalar)


@pytest.mark.parametrize(
    "name", ["sin", "sinf", "y1", "gamma", "state", "in", "out", "faults", "min", "k", "t2", "main"]
)
@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_a_signal_may_share_a_name_of_the_c(name: str, scalar: type[np.floating]) -> None:
    block = build(
        "shared",
        TIME,
        lambda u, x, k: Step({"y": ca.sin(u[name]) * ca.fmin(u[name], 2) + k["unused"]}),
        inputs=[signal(name)],
        outputs=[signal("y")],
        constants=[Constant("unused", 0.5, "1", "text that /* opens and */ closes"), Constant("idle", 1, "1", "test")],
    )
    compiler.check(c_files(block, scalar))
    y = load(block, scalar).replay({name: np.array([0.5, 3.0])}).outputs["y"]
    np.testing.assert_allclose(y, np.sin([0.5, 3.0]) * [0.5, 2] + 0.5, rtol=1e-6)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_a_block_that_reads_no_input_or_keeps_no_state_compiles_clean(scalar: type[np.floating]) -> None:
    still = build("still", TIME, lambda u, x, k: Step({"y": 0.25}), inputs=[signal("a")], outputs=[signal("y")])
    compiler.check(c_files(still, scalar))
    controller = load(still, scalar)
    assert controller.step(controller.init(), {"a": 1.0}).outputs == {"y": 0.25}


def test_comments_carry_tag_unit_range_and_cannot_be_closed_early() -> None:
    a = Signal("a", "kg m/s^2", -2, 3, "a */ force")
    block = build(
        "tagged", TIME, lambda u, x, k: Step({"y": 3 * u["a"]}), inputs=[a], outputs=[signal("y")], tag="F(12)"
    )
    files = c_files(replace(block, constants=()), np.float32)
    assert "/* tagged: F(12) */" in files["tagged.c"]
    assert "/* kg m/s^2, -2 .. 3: a * / force */" in files["tagged.h"]
    compiler.check(files)
