"""Range reduction before scaling, and cosine and sine by a quarter of the angle, against exact arithmetic."""

from fractions import Fraction
from functools import cache
from math import pi, sqrt

import casadi as ca
import mpmath
import numpy as np
import pytest
from numpy.typing import NDArray

from synth.block import Exprs, Step, build
from synth.blocks.estimate import phasor
from synth.emit import write
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.signals import Signal
from synth.timing import Discrete
from tests.c_code import without_comments

WAVE = 0.1143  # m
X = Signal("x", "m", -12.0, 12.0)  # 105 periods of travel
EPS = {np.float32: 2e-7, np.float64: 1e-14}  # of the polynomials
LENGTH = sqrt(2)


@cache
def emitted(scalar: type[np.floating]) -> EmittedCode:
    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        distance = phasor.within_period(u["x"], X, WAVE, "x")
        named = [(distance.signal, distance.value)]
        wave = phasor.by_quarter_angle(distance.value, WAVE, "x", named, LENGTH)
        output = {"c": wave.cosine, "s": wave.sine, "d": distance.value, "n": distance_of_scaled(u["x"])}
        return Step(output, named=named, certified={distance.signal.name: distance.certificate})

    outputs = [Signal(n, "1", -2, 2) for n in "cs"] + [Signal(n, "m", -1, 1) for n in "dn"]
    return write.emit(build("reduced", Discrete(1e-3), law, inputs=[X], outputs=outputs), scalar, error=EPS[scalar])


def distance_of_scaled(position: ca.SX) -> ca.SX:
    """Return the planted defect: a position that is scaled to turns first and reduced then."""
    turns = position * (1 / WAVE)
    return WAVE * (turns - (ca.floor(turns + 200.5) - 200))


def positions(scalar: type[np.floating]) -> NDArray[np.floating]:
    """Return numbers of the type, spread over the travel and close to the ends of half periods."""
    rng = np.random.default_rng(3)
    ends = (rng.integers(-100, 100, 3000) + 0.5) * WAVE * (1 + rng.normal(0, 1e-7, 3000))
    return np.concatenate([rng.uniform(-12, 12, 3000), ends, rng.normal(0, 1e-4, 500)]).astype(scalar)


def outputs(scalar: type[np.floating], x: NDArray[np.floating]) -> dict[str, NDArray[np.float64]]:
    code = emitted(scalar)
    replay = host.load(code.files, code.manifest).replay({"x": x})
    return {name: v.astype(np.float64) for name, v in replay.outputs.items()}


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_the_distance_has_the_accuracy_of_its_own_size(scalar: type[np.floating]) -> None:
    x, period = positions(scalar), Fraction(WAVE)
    computed = outputs(scalar, x)
    roundoff = float(np.finfo(scalar).eps) / 2
    errors, planted = [], []
    for v, d, n in zip(x, computed["d"], computed["n"], strict=True):
        for value, into in ((d, errors), (n, planted)):
            turns = round((Fraction(float(v)) - Fraction(value)) / period)
            into.append(abs(float(Fraction(float(v)) - turns * period - Fraction(value))))
    assert max(errors) < 2 * roundoff * WAVE / 2
    assert max(planted) > 30 * roundoff * WAVE  # a hundred periods cost seven bits
    assert np.abs(computed["d"]).max() <= WAVE / 2 * (1 + phasor.MARGIN)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_cosine_and_sine_keep_the_absolute_bound_of_the_header(scalar: type[np.floating]) -> None:
    x = positions(scalar)
    computed = outputs(scalar, x)
    with mpmath.workdps(40):
        angles = [2 * mpmath.pi * mpmath.mpf(float(d)) / mpmath.mpf(WAVE) for d in computed["d"]]
        true = {"c": [mpmath.cos(a) for a in angles], "s": [mpmath.sin(a) for a in angles]}
        worst = max(
            float(abs(v / mpmath.mpf(LENGTH) - t)) for n in "cs" for v, t in zip(computed[n], true[n], strict=True)
        )
    (surrogate,) = emitted(scalar).manifest["surrogates"]
    bound = phasor.quarter_angle_error(float(np.finfo(scalar).eps) / 2, surrogate["max_relative_error"])
    assert bound / 20 < worst <= bound
    length = np.hypot(computed["c"], computed["s"]) / LENGTH
    assert np.abs(length - 1).max() < 18 * float(np.finfo(scalar).eps) / 2


def test_the_c_calls_no_sine() -> None:
    code = without_comments(emitted(np.float32).files["reduced.c"])
    assert not [name for name in ("sin", "cos", "floor", "round") if f"{name}f(" in code or f"{name}(" in code]
    assert "admit" in code  # the limit of the distance is proved idle


def test_doublings_give_the_phasor_of_the_whole_angle() -> None:
    angle, named = ca.SX.sym("a"), []
    wave = phasor.by_range_reduction(angle, phasor.halvings(pi), "part", named)
    f = ca.Function("f", [angle], [wave.cosine, wave.sine])
    for a in np.linspace(-pi, pi, 17):
        assert [float(v) for v in f(a)] == pytest.approx([np.cos(a), np.sin(a)], abs=1e-14)
    assert [float(v) for v in f(pi / 2)] == pytest.approx([0.0, 1.0], abs=1e-14)


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_a_certified_reduction_has_no_limits_and_one_for_coarser_polynomials_has(scalar: type[np.floating]) -> None:
    angle = Signal("a", "rad", -7.0, 7.0)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        named: list[tuple[Signal, ca.SX]] = []
        wave, certified = phasor.by_certified_reduction(u["a"], phasor.halvings(7.0), "a", named)
        return Step({"c": wave.cosine, "s": wave.sine}, named=named, certified=certified)

    outputs = [Signal(n, "1", -2, 2) for n in "cs"]
    block = build("reduced", Discrete(1e-3), law, inputs=[angle], outputs=outputs)
    limits = {}
    for error in (EPS[scalar], 1e-4):
        made = write.emit(block, scalar, error=error)
        limits[error] = without_comments(made.files["reduced.c"]).count("_limit(")
    made = write.emit(block, scalar, error=EPS[scalar])
    a = np.linspace(-7, 7, 4001)
    out = (
        host.load(made.files, made.manifest)
        .batch(np.repeat(host.load(made.files, made.manifest).init()[None], len(a)), {"a": a.astype(scalar)})
        .outputs
    )
    assert np.abs(out["s"] - np.sin(a.astype(scalar))).max() < 64 * EPS[scalar]
    assert limits[EPS[scalar]] < limits[1e-4]
