"""Functions that are written out or exact in every libm: the C in float32 beside NumPy in float32 and mpmath."""

from collections.abc import Callable
from typing import Any

import casadi as ca
import mpmath
import numpy as np
import pytest

from synth.block import Block, Fault, Step, build
from synth.emit.write import emit
from synth.errors import EmitError
from synth.execute import host, target
from synth.signals import Signal
from synth.timing import Discrete
from tests import tools

F32 = np.float32
LARGEST = 2.0**31 - 128
TINY = [1e-45, 1e-40, 1.2e-38, 1e-20]
EDGES = [0.0, *TINY, 0.1, 0.5, 1 - 2.0**-24, 1.0, 1 + 2.0**-23, 1.5, 2.5, 3.0, 7.75, 1e6 + 0.5, 2.0**22 + 0.5]
EDGES += [2.0**23 - 0.5, 2.0**23, 2.0**24, 2.0**30, LARGEST]
Function = Callable[..., Any]


def make(f: Function, *inputs: Signal, high: float = 1e38) -> Block:
    return build(
        "made",
        Discrete(1e-3),
        lambda u, x, k: Step({"y": f(*(u[s.name] for s in inputs))}),
        inputs=inputs,
        outputs=[Signal("y", "1", -high, high)],
    )


def of(name: str, low: float, high: float) -> Signal:
    return Signal(name, "1", low, high)


def computed(block: Block, *columns: Any) -> Any:
    """Return y of the C in float32 for columns of inputs."""
    names = [s.name for s in block.inputs]
    return host.compile_block(block).replay(dict(zip(names, columns, strict=True))).outputs["y"]


def samples(seed: int, low: float, high: float) -> Any:
    """Return edges of both signs and random numbers of all sizes, inside low .. high."""
    rng = np.random.default_rng(seed)
    drawn = rng.normal(size=300) * 10.0 ** rng.uniform(-12, 9, size=300)
    x = np.array([*EDGES, *(-v for v in EDGES), *drawn, *np.round(drawn)]).astype(F32)
    return x[(low <= x) & (x <= high)]


@pytest.mark.parametrize(("f", "exact"), [(ca.sign, np.sign), (ca.floor, np.floor), (ca.ceil, np.ceil)])
@pytest.mark.parametrize(("low", "high"), [(-LARGEST, LARGEST), (-5.0, 3.0), (0.0, 9.0), (-7.0, -0.25), (0.5, 2.0)])
def test_whole_parts_and_signs_are_exact(f: Function, exact: Function, low: float, high: float) -> None:
    x = samples(1, low, high)
    np.testing.assert_array_equal(computed(make(f, of("a", low, high)), x), exact(x))


def remainder(a: Any, b: Any) -> Any:
    return np.array([mpmath.mpf(float(u)) - mpmath.mpf(float(v)) * mpmath.nint(mpmath.mpf(float(u)) / float(v))
                     for u, v in zip(a, b, strict=True)], dtype=np.float64)  # fmt: skip


@pytest.mark.parametrize(("f", "exact"), [(ca.fmod, np.fmod), (ca.remainder, remainder)])
@pytest.mark.parametrize(
    ("low", "high"), [(1e-45, 1e9), (2 * np.pi, 7.0), (0.5, 0.5 + 1e-6), (-9.0, -1e-3), (3.0, 4.0)]
)
def test_remainders_are_exact(f: Function, exact: Function, low: float, high: float) -> None:
    a = samples(2, -1e9, 1e9)
    b = np.random.default_rng(3).uniform(low, high, size=len(a)).astype(F32).clip(F32(low), F32(high))
    with mpmath.workdps(80):
        np.testing.assert_array_equal(computed(make(f, of("a", -1e9, 1e9), of("b", low, high)), a, b), exact(a, b))


@pytest.mark.parametrize("compiler", tools.CROSS_COMPILERS)
def test_an_emulated_core_gives_the_bits_of_the_host(compiler: str) -> None:
    functions: list[Function] = [ca.fmod, ca.remainder, ca.copysign, ca.hypot, lambda a, b: b**2.5 - b**-0.5]
    functions += [lambda a, b: ca.sign(a), lambda a, b: ca.floor(a) + ca.ceil(a / 7)]
    block = make(lambda a, b: sum(f(a, b) for f in functions), of("a", -1e6, 1e6), of("b", 0.125, 9))
    emitted = emit(block, F32)
    a, b = samples(8, -1e6, 1e6), np.resize(samples(9, 0.125, 9), len(samples(8, -1e6, 1e6)))
    core = target.load(emitted.files, emitted.manifest, "cortex-m4f", compiler)
    expected = host.load(emitted.files, emitted.manifest).replay({"a": a, "b": b}).outputs["y"]
    assert core.replay({"a": a, "b": b}).outputs["y"].tobytes() == expected.tobytes()


def test_a_size_takes_the_sign_of_another_number_and_a_zero_has_none() -> None:
    a, b = samples(4, -9, 9), np.random.default_rng(5).permutation(samples(4, -9, 9))
    y = computed(make(ca.copysign, of("a", -9, 9), of("b", -9, 9)), a, b)
    np.testing.assert_array_equal(y, np.copysign(a, b + F32(0)))  # -0 + 0 is 0


@pytest.mark.parametrize(
    "f", [ca.hypot, lambda a, b: ca.norm_2(ca.vertcat(a, b)), lambda a, b: ca.norm_2(ca.vertcat(b, a))]
)
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e5, 1e18])
def test_a_distance_errs_by_two_units(f: Function, size: float) -> None:
    rng = np.random.default_rng(6)
    a, b = (rng.uniform(-size, size, 400).astype(F32) for _ in "ab")
    y = computed(make(f, of("a", -size, size), of("b", -size, size)), a, b)
    exact = np.hypot(a.astype(np.float64), b.astype(np.float64))
    assert (np.abs(y - exact) <= 2 * np.spacing(exact.astype(F32))).all()
    assert computed(make(f, of("a", -size, size), of("b", -size, size)), [0.0], [0.0])[0] == 0


@pytest.mark.parametrize("exponent", [0.5, 1.5, 2.5, 7.5, -0.5, -1.0, -1.5, -3.0, 1 / 3, 0.7, -2.2, 20.0, 31.5])
@pytest.mark.parametrize(("low", "high"), [(0.5, 2.0), (0.9, 1.1)])
def test_a_power_by_a_number_is_within_its_error(exponent: float, low: float, high: float) -> None:
    x = np.linspace(low, high, 500).astype(F32).clip(F32(low), F32(high))
    y = computed(make(lambda a: a**exponent, of("a", low, high)), x)
    exact = [float(mpmath.mpf(float(v)) ** exponent) for v in x]
    np.testing.assert_allclose(y, exact, rtol=(4 + abs(exponent)) * 2.0**-23)


def test_a_power_of_two_signals_and_a_square_root_from_zero() -> None:
    x, e = np.linspace(0.5, 3, 200).astype(F32), np.linspace(-2, 2, 200).astype(F32)
    y = computed(make(lambda a, b: a**b, of("a", 0.5, 3), of("b", -2, 2)), x, e)
    np.testing.assert_allclose(y, x.astype(np.float64) ** e, rtol=16 * 2.0**-23)
    x = np.linspace(0, 4, 200).astype(F32)
    np.testing.assert_allclose(
        computed(make(lambda a: a**1.5, of("a", 0, 4)), x), x.astype(np.float64) ** 1.5, rtol=1e-6
    )


@pytest.mark.parametrize(
    ("f", "exact", "low", "high"),
    [
        (ca.expm1, mpmath.expm1, -0.5, 0.7),
        (ca.expm1, mpmath.expm1, -1e-3, 1e-3),
        (ca.expm1, mpmath.expm1, 0.0, 2.0),
        (ca.expm1, mpmath.expm1, 1.0, 3.0),
        (ca.expm1, mpmath.expm1, -3.0, 60.0),
        (ca.log1p, mpmath.log1p, -0.3, 0.5),
        (ca.log1p, mpmath.log1p, -1e-3, 1e-3),
        (ca.log1p, mpmath.log1p, 0.0, 0.5),
        (ca.log1p, mpmath.log1p, 1.0, 3.0),
        (ca.log1p, mpmath.log1p, -0.999, 1e6),
        (ca.asinh, mpmath.asinh, -0.5, 0.7),
        (ca.asinh, mpmath.asinh, -1e-3, 1e-3),
        (ca.asinh, mpmath.asinh, 0.0, 1.0),
        (ca.asinh, mpmath.asinh, -30.0, 30.0),
        (ca.asinh, mpmath.asinh, -1e30, 1e6),
        (ca.erf, mpmath.erf, -0.5, 0.7),
        (ca.erf, mpmath.erf, -1e-3, 1e-3),
        (ca.erf, mpmath.erf, 0.0, 1.0),
        (ca.erf, mpmath.erf, 1.0, 3.0),
        (ca.erf, mpmath.erf, -60.0, 10.0),
    ],
)
def test_functions_near_zero_keep_their_relative_error(f: Function, exact: Function, low: float, high: float) -> None:
    block = make(f, of("a", low, high))
    near = [v for v in (0.0, *TINY, *(-v for v in TINY)) if low <= v <= high]
    x = np.array([*near, *np.linspace(low, high, 400)]).astype(F32).clip(F32(low), F32(high))
    polynomials = emit(block, F32).manifest["surrogates"]
    allowed = polynomials[0]["max_relative_error"] if polynomials else 4 * 2.0**-23
    expected = np.array([float(exact(mpmath.mpf(float(v)))) for v in x])
    assert (np.abs(computed(block, x) - expected) <= allowed * np.abs(expected) + 1.5e-45).all()
    assert bool(polynomials) == (high <= 3.0)


UNSAFE = [
    (lambda a: ca.floor(a), (-3e9, 1.0), "the floor of"),
    (lambda a: ca.ceil(a), (0.0, 3e9), "the floor of"),
    (lambda a: ca.fmod(1, a), (-1.0, 1.0), "the fmod of `a`"),
    (lambda a: ca.remainder(1, a), (0.0, 1.0), "the remainder of `a`"),
    (lambda a: ca.log1p(a), (-1.0, 1.0), "the argument is -1 at a = -1"),
    (lambda a: a**1.5, (-1.0, 1.0), "the sqrt of `a`"),
    (lambda a: a**-1.5, (0.0, 1.0), "the division by"),
    (lambda a: a**0.3, (0.0, 1.0), "the log of `a`"),
    (lambda a: 1 / ca.sign(a), (-1.0, 1.0), "the denominator is 0 at a = 0"),
    (lambda a: 1 / ca.floor(a), (0.5, 9.0), r"by `floor\(a\)` .* the denominator is 0 at a = 0.5"),
    (lambda a: 1 / ca.ceil(a), (-0.5, 9.0), "the denominator is -?0 at a = -0.5"),
    (lambda a: 1 / ca.fmod(a, 3), (1.0, 4.0), "the denominator"),
    (lambda a: 1 / ca.hypot(a, 0), (-1.0, 1.0), "the denominator is 0 at a = 0"),
    (lambda a: ca.hypot(a, 1), (-1e30, 1e30), "a finite number|declared range"),
]


@pytest.mark.parametrize(("f", "ends", "words"), UNSAFE)
def test_what_is_not_defined_everywhere_is_refused(f: Function, ends: tuple[float, float], words: str) -> None:
    with pytest.raises(EmitError, match=words):
        emit(make(f, of("a", *ends)), F32)


SAFE: list[tuple[Function, tuple[float, float]]] = [
    (lambda a: 1 / (ca.sign(a) + 2), (-1.0, 1.0)),
    (lambda a: 1 / ca.sign(a), (0.1, 1.0)),
    (lambda a: 1 / ca.floor(a), (-9.0, -0.5)),
    (lambda a: 1 / ca.floor(a), (1.0, 9.0)),
    (lambda a: 1 / (ca.floor(a) + 0.5), (-9.0, 9.0)),
    (lambda a: 1 / ca.ceil(a), (0.5, 9.0)),
    (lambda a: 1 / (ca.fmod(a, 3) + 3.5), (-100.0, 100.0)),
    (lambda a: 1 / ca.fmod(a, 3), (1.0, 2.0)),
    (lambda a: 1 / (ca.remainder(a, 3) + 1.75), (-100.0, 100.0)),
    (lambda a: 1 / ca.hypot(a, 1), (-1e3, 1e3)),
    (lambda a: ca.sqrt(ca.copysign(a, 1)), (-1.0, 1.0)),
    (lambda a: a**-0.5, (1e-3, 1.0)),
    (lambda a: 1 / (a + ca.copysign(1e-3, a)), (-1.0, 1.0)),
    (lambda a: ca.log1p(ca.fmax(a, -0.5)), (-3.0, 1.0)),
    (lambda a: ca.if_else(ca.sign(a) > 0, 1 / (a + 1e-3), 0), (-1.0, 1.0)),
]


@pytest.mark.parametrize(("f", "ends"), SAFE)
def test_what_is_defined_everywhere_is_emitted(f: Function, ends: tuple[float, float]) -> None:
    block = make(f, of("a", *ends))
    assert np.isfinite(computed(block, np.linspace(*ends, 1000).astype(F32).clip(F32(ends[0]), F32(ends[1])))).all()


@pytest.mark.parametrize("f", [ca.floor, ca.ceil, lambda a: ca.fmod(a, 2), ca.expm1, lambda a: ca.hypot(a, 1)])
def test_an_input_of_any_bit_pattern_is_refused(f: Function) -> None:
    block = make(lambda a, b: ca.if_else(b > 0, f(a), 0), of("a", -1, 1), of("b", -1, 1))
    from dataclasses import replace

    with pytest.raises(EmitError):
        emit(replace(block, faults=(Fault(0, "y", "a"),)), F32)
