"""A kink has no derivative: plants and Blocks at it are refused, smooth models beside it are not."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth import block
from synth.analyse.loops import loop
from synth.analyse.numerics import derivatives
from synth.analyse.operating_points import OperatingPoint, linearise
from synth.block import Block, State, Step
from synth.errors import ModelError, SignalError
from synth.plant import Plant, build
from synth.signals import Signal
from synth.statespace import StateSpace
from synth.timing import Discrete
from tests import tolerances

EXACT = tolerances.of("double")
Z, V, U = Signal("z", "m", -1, 1), Signal("v", "m/s", -2, 2), Signal("u", "N", -1, 1)
Force = Callable[[ca.SX, ca.SX, ca.SX], ca.SX]


def mass(force: Force) -> Plant:
    """1 kg in z under a force of z, v and u."""
    return build(
        "mass", [Z, V], [U], [Z], [], lambda x, u, p: ({"z": x["v"], "v": force(x["z"], x["v"], u["u"])}, {"z": x["z"]})
    )


def at(plant: Plant, force: Force, z: float = 0.0, v: float = 0.0, u: float = 0.0) -> StateSpace:
    x = np.array([z, v])
    return linearise(plant, OperatingPoint(x, np.array([u]), np.zeros(0), 0.0, ("z", "v"), ("u",)))


def one_sided(force: Force, which: str, place: dict[str, float]) -> tuple[float, float]:
    """Return the slopes of the force below and above the point, by differences."""
    symbols = [ca.SX.sym(n) for n in "zvu"]
    f = ca.Function("f", symbols, [force(*symbols)])

    def value(by: float) -> float:
        moved = {"z": 0.0, "v": 0.0, "u": 0.0} | place
        return float(f(*(moved | {which: moved[which] + by}).values()))

    h = 1e-6
    return (value(-h) - value(-2 * h)) / h, (value(2 * h) - value(h)) / h


COUNTS = block.table("counts", [1.0, 2.0, 4.0])
SLOPES: list[tuple[str, Force, dict[str, float]]] = [
    ("z", lambda z, v, u: -1e4 * ca.fmax(0, z), {}),
    ("z", lambda z, v, u: -1e4 * ca.fmin(z + 0.5, 0), {"z": -0.5}),
    ("z", lambda z, v, u: ca.fabs(z - 0.2) - z, {"z": 0.2}),
    ("z", lambda z, v, u: ca.if_else(z > 0, -1e4 * z - 5 * v, 0), {}),
    ("u", lambda z, v, u: 3 * ca.fmax(ca.fmin(u, 0.5), -0.5), {"u": 0.5}),
    ("u", lambda z, v, u: 3 * ca.fmax(ca.fmin(u, 0.5), -0.5), {"u": -0.5 + 1e-13}),
    ("v", lambda z, v, u: -v * ca.sign(v) - v, {}),
    ("z", lambda z, v, u: ca.sin(3 * ca.fabs(z)) * ca.exp(v), {"v": 0.3}),
    ("z", lambda z, v, u: ca.if_else(ca.logic_and(z > 0, v >= 0), z, 2 * z), {"v": 0.1}),
    ("z", lambda z, v, u: ca.fmax(z, v) - 2 * z, {"z": 0.3, "v": 0.3}),
    ("z", lambda z, v, u: block.dot([ca.SX(2), ca.SX(-1e4)], [v, ca.fmax(0, z)]), {}),
    ("z", lambda z, v, u: ca.copysign(0.5 * z + 1, 1) * ca.fabs(z), {}),
]  # fmt: skip


@pytest.mark.parametrize(("which", "force", "place"), SLOPES)
def test_a_kink_is_refused_with_both_slopes(which: str, force: Force, place: dict[str, float]) -> None:
    below, above = one_sided(force, which, place)
    with pytest.raises(
        ModelError, match=f"plant 'mass' has no derivative at the point: d.v./dt .* {which} = "
    ) as error:
        at(mass(force), force, **place)
    words = str(error.value).split()
    slopes = [float(words[words.index(side) - 1]) for side in ("below", "above")]
    assert slopes == pytest.approx([below, above], rel=1e-4, abs=1e-4)
    beside = [float(words[words.index("or") + k]) for k in (-1, 1)]
    assert [at(mass(force), force, **(place | {which: z})) is not None for z in beside] == [True, True]


@pytest.mark.parametrize(
    ("force", "place", "limits"),
    [
        (lambda z, v, u: -0.5 * ca.sign(v), {}, "from 0.5 to -0.5 at v = 0 m/s"),
        (lambda z, v, u: ca.floor(10 * u) / 10, {"u": 0.3}, "from 0.2 to 0.3 at u = 0.3 N"),
        (lambda z, v, u: ca.ceil(10 * u) / 10, {"u": 0.3}, "from 0.3 to 0.4 at u = 0.3 N"),
        (lambda z, v, u: ca.fmod(z, 0.25), {"z": 0.5}, "from 0.25 to 0 at z = 0.5 m"),
        (lambda z, v, u: ca.remainder(z, 0.5), {"z": 0.25}, "from 0.25 to -0.25 at z = 0.25 m"),
        (lambda z, v, u: ca.if_else(z < 0.5, 1, 3), {"z": 0.5}, "from 1 to 3 at z = 0.5 m"),
        (lambda z, v, u: ca.atan2(z, u) / np.pi, {"u": -0.5}, "from -1 to 1 at z = 0 m"),
        (lambda z, v, u: COUNTS(ca.floor(2 * z + 1)), {"z": 0.0}, "from 1 to 2 at z = 0 m"),
    ],
)
def test_a_jump_is_refused_with_both_values(force: Force, place: dict[str, float], limits: str) -> None:
    with pytest.raises(ModelError, match=r"d\(v\)/dt jumps " + limits):
        at(mass(force), force, **place)


@pytest.mark.parametrize(
    "force", [lambda z, v, u: ca.sqrt(ca.fabs(z)), lambda z, v, u: ca.hypot(z, v), lambda z, v, u: ca.fabs(z) ** 0.3]
)
def test_a_slope_that_is_not_finite_is_refused_by_name(force: Force) -> None:
    with pytest.raises(SignalError, match=r"A\[1, 0\] is (nan|inf), that of 'v' by 'z': all entries must be finite"):
        at(mass(force), force)


def test_a_kink_of_several_signals_is_refused() -> None:
    def force(z: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        return ca.fabs(z + v) - ca.fabs(z - v)

    with pytest.raises(ModelError, match="kink where several signals change together"):
        at(mass(force), force)


@pytest.mark.parametrize(
    ("force", "place", "slopes"),
    [
        (lambda z, v, u: z * ca.fabs(z), {}, (0, 0, 0)),
        (lambda z, v, u: -v * ca.fabs(v), {"v": 1e-13}, (0, -2e-13, 0)),
        (lambda z, v, u: ca.fmax(z, 0) + ca.fmin(z, 0), {}, (1, 0, 0)),
        (lambda z, v, u: ca.if_else(z > 0, z, 0) + ca.if_else(z < 0, z, 0), {}, (1, 0, 0)),
        (lambda z, v, u: ca.if_else(z < 0.5, z**2, z - 0.25), {"z": 0.5}, (1, 0, 0)),
        (lambda z, v, u: ca.atan2(z, u), {"z": 0.3, "u": 0.4}, (1.6, 0, -1.2)),
        (lambda z, v, u: -1e4 * ca.fmax(0, z), {"z": 1e-6}, (-1e4, 0, 0)),
        (lambda z, v, u: -1e4 * ca.fmax(0, z), {"z": -1e-6}, (0, 0, 0)),
        (lambda z, v, u: ca.fmax(0, z) * v + u, {}, (0, 0, 1)),
        (lambda z, v, u: ca.if_else(z == 0, 1, ca.sin(z) / z) + u, {}, (0, 0, 1)),
        (lambda z, v, u: ca.if_else(ca.fabs(z) < 1e-8, 1, ca.sin(z) / z) + u, {}, (0, 0, 1)),
        (lambda z, v, u: ca.if_else(z**2 > 0, 0, z) + u, {"z": 1e-31}, (0, 0, 1)),
        (lambda z, v, u: ca.tanh(v / 1e-6) + ca.fabs(u), {"v": 6e-7, "u": 0.5}, (0, 1e6 / np.cosh(0.6) ** 2, 1)),
        (lambda z, v, u: ca.sqrt(z**2 + 1e-18) + ca.fabs(u), {"z": 1e-9, "u": 0.5}, (np.sqrt(0.5), 0, 1)),
        (
            lambda z, v, u: ca.interpolant("law", "bspline", [[-1, 0, 1, 2]], [1, 0, 1, 8])(z) + ca.fabs(u),
            {"u": 0.5},
            None,
        ),
    ],
)
def test_what_is_smooth_at_the_point_has_its_derivative(
    force: Force, place: dict[str, float], slopes: tuple[float, ...] | None
) -> None:
    model = at(mass(force), force, **place)
    if slopes is None:  # of an interpolant: those of CasADi
        symbols = [ca.SX.sym(n) for n in "zvu"]
        J = ca.Function("J", symbols, [ca.jacobian(force(*symbols), ca.vcat(symbols))])
        slopes = tuple(np.asarray(J(*({"z": 0.0, "v": 0.0, "u": 0.0} | place).values())).ravel())
    np.testing.assert_allclose([*model.A[1], *model.B[1]], slopes, rtol=1e-9, atol=EXACT)


def test_a_range_that_stands_for_any_value_moves_no_point() -> None:
    wide = replace(U, low=-1e30, high=1e30)
    plant = build("drive", [V], [wide], [V], [], lambda x, u, p: ({"v": ca.fmin(u["u"], 2.0)}, {"v": x["v"]}))
    model = linearise(plant, OperatingPoint(np.zeros(1), np.zeros(1), np.zeros(0), 0.0, ("v",), ("u",)))
    assert model.B.tolist() == [[1.0]]


def held_pd(low: float = -1.0) -> Block:
    """A law with a dead zone, a state that decays to its bound 0, and one that counts."""
    fade, count = State(Signal("fade", "1", low, 1), 0.0), State(Signal("count", "1", 0, 5), 0, integer=True)

    def law(u: block.Exprs, x: block.Exprs, k: block.Exprs) -> Step:
        error = u["wish"] - u["z"]
        wide = ca.if_else(ca.fabs(error) > 0.1, error - 0.1 * ca.sign(error), 0)
        steps = {"fade": 0.5 * x["fade"], "count": ca.if_else(x["count"] > 0, x["count"] - 1, 0)}
        return Step({"force": 4 * wide + ca.fmin(u["wish"], 0.5) + x["fade"]}, steps)

    wish = replace(Z, name="wish")
    force = Signal("force", "N", -10, 10)
    return block.build("law", Discrete(0.01), law, inputs=[Z, wish], outputs=[force], states=[fade, count])


def test_a_block_is_refused_at_a_kink_of_what_moves() -> None:
    law = held_pd()
    with pytest.raises(ModelError, match=r"block 'law' .* output 'force' has the slope -4 below and 0 above z = 0.2 m"):
        loop.linearise_block(law, {}, {"z": 0.2, "wish": 0.3})
    with pytest.raises(ModelError, match=r"slope 5 below and 4 above wish = 0.5 m"):
        loop.linearise_block(law, {}, {"z": 0.2, "wish": 0.5})
    model = loop.linearise_block(law, {}, {"z": 0.2, "wish": 0.5}, held=["wish"])
    assert model.inputs == ("z",) and model.D.tolist() == [[-4.0]]


def test_a_state_at_its_bound_moves_inwards() -> None:
    """CasADi's derivative of max(0.5 x, 0) at 0 is the mean of both sides, 0.25."""
    model = loop.linearise_block(held_pd(0.0), {}, {"z": 0.0, "wish": 0.3})
    assert model.A.tolist() == [[0.5, 0.0], [0.0, 0.0]] and model.C.tolist() == [[1.0, 0.0]]
    assert model.D.tolist() == [[-4.0, 5.0]]
    alone = loop.linearise_block(held_pd(0.0), {}, {"z": 0.0, "wish": 0.3}, held=["wish"])
    assert alone.A.tolist() == [[0.5, 0.0], [0.0, 0.0]] and alone.D.tolist() == [[-4.0]]


@pytest.mark.parametrize(
    ("reads", "moves"), [("r", False), ("y", True), ("p", False), ("r + y", True), ("0.5 * p + 1e-3 * y", True)]
)
def test_a_state_that_only_a_held_input_reaches_does_not_move(reads: str, moves: bool) -> None:
    """A feedforward of Coulomb friction, sign(r - r before), jumps at rest, where r is held; so p, a prefilter of r."""

    def law(u: block.Exprs, x: block.Exprs, k: block.Exprs) -> Step:
        now = eval(reads, {"r": u["r"], "y": u["y"], "p": x["p"]})
        return Step({"u": ca.sign(now - x["before"]) - u["y"]}, {"p": 0.9 * x["p"] + 0.1 * u["r"], "before": now})

    r, y = Signal("r", "m", -1, 1), Signal("y", "m", -1, 1)
    states = [State(Signal(n, "m", -1, 1), 0.0) for n in ("p", "before")]
    forward = block.build("forward", Discrete(1e-3), law, inputs=[r, y], outputs=[U], states=states)
    rest: dict[str, float] = {"r": 0.0, "y": 0.0}
    with pytest.raises(ModelError, match="the output 'u' "):
        loop.linearise_block(forward, {}, rest)
    if moves:
        with pytest.raises(ModelError, match="the output 'u' "):
            loop.linearise_block(forward, {}, rest, ["r"])
    else:
        model = loop.linearise_block(forward, {}, rest, ["r"])
        np.testing.assert_array_equal(model.D, [[-1.0]])
        np.testing.assert_array_equal(model.A[0], [0.9, 0.0])


def test_a_point_that_takes_one_branch_has_the_slopes_that_its_directions_have(monkeypatch: pytest.MonkeyPatch) -> None:
    def force(z: ca.SX, v: ca.SX, u: ca.SX) -> ca.SX:
        limited = ca.fmin(ca.fmax(3 * z - v, -0.5), 0.5)
        return ca.if_else(z > 0.1, limited * u, ca.fabs(v) * z) + ca.floor(4 * u) * z

    plant, decisions = mass(force), []
    takes_one_branch = derivatives._takes_one_branch

    def recorded(*args: Any) -> bool:
        decisions.append(takes_one_branch(*args))
        return decisions[-1]

    monkeypatch.setattr(derivatives, "_takes_one_branch", recorded)
    places = np.random.default_rng(5).uniform(-0.9, 0.9, (20, 3)).tolist()
    quick = [at(plant, force, *place) for place in places]
    assert all(decisions)
    monkeypatch.setattr(derivatives, "_takes_one_branch", lambda *_: False)
    for model, place in zip(quick, places, strict=True):
        np.testing.assert_allclose(model.A, at(plant, force, *place).A, rtol=1e-12, atol=1e-12)
    monkeypatch.setattr(derivatives, "_takes_one_branch", recorded)
    equal = lambda z, v, u: ca.fmax(ca.if_else(u > -0.5, 0, z), 0) + u  # noqa: E731
    assert at(mass(equal), equal).B.tolist() == [[0.0], [1.0]] and decisions[-1]  # limits with one slope on both sides
    hidden = lambda z, v, u: ca.fmax(1 + 1e-5 * z, 1)  # noqa: E731  # 1 + 2e-17 is rounded to 1
    with pytest.raises(ModelError, match="has the slope 0 below and 1e-05 above z = 0"):
        at(mass(hidden), hidden)
    for kink in ({"z": 0.1, "v": 0.3, "u": 0.2}, {"z": -0.5, "v": 0.0}, {"z": 0.5, "v": 0.1, "u": 0.5}):
        with pytest.raises(ModelError):
            at(plant, force, **kink)
    assert not any(decisions[-3:])
