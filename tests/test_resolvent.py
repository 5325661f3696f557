"""The response at many points against elimination in sixty digits, and at points where rounding decides."""

import tracemalloc
from typing import Any

import control
import mpmath as mp
import numpy as np
import pytest

from synth import resolvent
from synth.errors import ModelError, SignalError
from synth.statespace import StateSpace, of

FAR = 10.0 + 1j * np.arange(
    resolvent.MAX_ELIMINATION_POINTS
)  # points that make the list long enough for the Schur form


def truth(model: StateSpace, v: Any) -> Any:
    """Return the response (k, p, m) by elimination in sixty digits."""
    with mp.workdps(60):
        A, B, C = (mp.matrix(M.tolist()) for M in (model.A, model.B, model.C))
        shifted = [mp.mpc(x.real, x.imag) * mp.eye(len(model.A)) - A for x in v.tolist()]
        columns = [[mp.lu_solve(M, B[:, j]) for j in range(B.cols)] for M in shifted]
        X = [C * mp.matrix([[x[i] for x in each] for i in range(A.rows)]) for each in columns]
        return np.array([M.tolist() for M in X], dtype=np.complex128) + model.D


def elimination(model: StateSpace, v: Any) -> Any:
    shifted = v[:, None, None] * np.eye(len(model.A)) - model.A
    return model.C @ np.linalg.solve(shifted, np.broadcast_to(model.B, (len(v), *model.B.shape))) + model.D


def flexible(damping: float, modes: int = 10) -> StateSpace:
    w, k = np.geomspace(0.5, 2e4, modes), 2 * np.arange(modes)
    A, B, C = np.zeros((2 * modes, 2 * modes)), np.zeros((2 * modes, 1)), np.zeros((1, 2 * modes))
    A[k, k + 1], A[k + 1, k], A[k + 1, k + 1] = 1.0, -(w**2), -2 * damping * w
    B[k + 1], C[0, k] = 1.0, np.sqrt(w)
    return of((A, B, C, np.zeros((1, 1))))


def dense(n: int, m: int = 1, p: int = 1, seed: int = 1) -> StateSpace:
    rng = np.random.default_rng(seed)
    return of(tuple(rng.standard_normal(shape) for shape in ((n, n), (n, m), (p, n), (p, m))))


def in_unlike_units(seed: int = 2) -> StateSpace:
    model, unit = dense(20), 10.0 ** np.random.default_rng(seed).uniform(-8, 8, 20)
    return of((model.A * unit[:, None] / unit, model.B * unit[:, None], model.C / unit, model.D))


COMPANION = of(control.tf([1.0], np.poly(-np.geomspace(1, 1e6, 12))))
W = 1j * np.geomspace(0.5, 2e4, 10)
HARD = {
    "a companion form over six decades": (COMPANION, 1j * np.geomspace(1e-2, 1e7, 12)),
    "modes damped by 1e-3, at resonance": (flexible(1e-3), W),
    "modes damped by 1e-6, at resonance": (flexible(1e-6), W),
    "modes damped by 1e-6, far below": (flexible(1e-6), 1j * np.geomspace(1e-6, 1e-1, 5)),
    "unlike units": (in_unlike_units(), 1j * np.geomspace(1e-3, 1e3, 8)),
    "1e-8 beside poles": (dense(20), dense(20).poles * (1 + 1e-8)),
    "several channels": (dense(30, 2, 3), 1j * np.geomspace(1e-2, 1e2, 5)),
    "more inputs than outputs": (dense(30, 3, 1), 1j * np.geomspace(1e-2, 1e2, 5)),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", HARD)
def test_many_points_are_as_exact_as_elimination_at_each(name: str) -> None:
    """A factor of 30 over elimination: both are exact for entries of A that are off by a few roundings."""
    model, v = HARD[name]
    expected = truth(model, v)
    size = np.abs(expected).max(axis=(1, 2))
    error, bound = (
        float((np.abs(M - expected).max(axis=(1, 2)) / size).max())
        for M in (model.response(np.concatenate([v, FAR]))[: len(v)], elimination(model, v))
    )
    assert error < 30 * max(bound, 1e-15)


def test_a_schur_form_without_refinement_would_be_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    model, v = HARD["a companion form over six decades"]
    monkeypatch.setattr(resolvent, "_is_backward_stable", lambda A, B, v, X, residual: np.ones(len(v), dtype=bool))
    assert np.abs(model.response(np.concatenate([v, FAR]))[: len(v)] / truth(model, v) - 1).max() > 1.0


def with_columns(model: StateSpace, m: int = 6) -> StateSpace:
    """Return the model with m random inputs and outputs, each state's in its own unit."""
    rng, n = np.random.default_rng(4), len(model.A)
    B, C = (
        np.abs(M) + M.any() * rng.uniform(0.1, 1, shape)
        for M, shape in ((model.B[:, :1], (n, m)), (model.C[:1], (m, n)))
    )
    return of((model.A, B * rng.standard_normal(m), C * rng.standard_normal((m, 1)), np.zeros((m, m))))


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["a companion form over six decades", "modes damped by 1e-6, at resonance", "unlike units"]
)
def test_many_columns_are_as_exact_as_few(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Both Schur forms are wrong for a companion form: they do not agree, and the residual decides."""
    narrow, v = HARD[name]
    model, points = with_columns(narrow), np.concatenate([v, 10.0 + 1j * np.arange(400)])
    assert 6 * len(points) >= resolvent.MIN_COLUMNS * len(model.A)
    expected = truth(model, v)
    size = np.abs(expected).max(axis=(1, 2))
    error, bound = (
        float((np.abs(M[: len(v)] - expected).max(axis=(1, 2)) / size).max())
        for M in (model.response(points), elimination(model, v))
    )
    assert error < 30 * max(bound, len(model.A) * resolvent.AGREEMENT / 30)
    if name == "a companion form over six decades":
        monkeypatch.setattr(resolvent, "AGREEMENT", np.inf)
        wrong = np.abs(model.response(points)[: len(v)] - expected).max(axis=(1, 2)) / size
        assert wrong.max() > 1e3 * error


CHAIN = np.diag(np.ones(11), 1)
INTEGRATORS = of((CHAIN, np.eye(12, 1, -11), np.eye(1, 12)))
DIAGONAL = of((np.diag(-np.arange(1.0, 13.0)), np.ones((12, 1)), np.ones((1, 12))))
COMPANION_AT_0 = of(control.tf([1.0], [*np.poly(-np.arange(1.0, 12.0)), 0.0]))


@pytest.mark.parametrize(
    ("model", "pole"), [(INTEGRATORS, 0.0), (DIAGONAL, -7.0), (COMPANION_AT_0, 0.0)], ids=["chain", "diagonal", "at 0"]
)
def test_a_pole_among_many_points_is_named(model: StateSpace, pole: float) -> None:
    with pytest.raises(ModelError, match=rf"no value at {pole:g}, a pole: leave it out"):
        model.response([*FAR, pole])
    wide = of((model.A, np.tile(model.B, 40), model.C, np.zeros((1, 40))))
    with pytest.raises(ModelError, match=rf"no value at {pole:g}, a pole: leave it out"):
        of((model.A.T, wide.C.T * np.ones((1, 40)), wide.B.T)).response([*FAR, pole])


def test_a_thousand_points_of_200_states_take_little_memory() -> None:
    model, v = dense(200, 2, 2), 1j * np.geomspace(1e-2, 1e2, 1000)
    tracemalloc.start()
    try:
        response = model.response(v)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert response.shape == (1000, 2, 2) and peak < 50e6


def test_repeated_points_are_solved_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    model, v = dense(12, 2, 2), 1j * np.arange(1.0, 31.0)
    once, counts = model.response(v), []
    solve = resolvent.Schur.solve
    monkeypatch.setattr(resolvent.Schur, "solve", lambda form, v, right: counts.append(len(v)) or solve(form, v, right))
    again = model.response(np.repeat(v[::-1], 50))
    np.testing.assert_array_equal(again, np.repeat(once[::-1], 50, axis=0))
    assert max(counts) <= len(v)


@pytest.mark.parametrize(("n", "m", "p"), [(0, 2, 1), (12, 0, 2), (12, 2, 0), (0, 0, 0), (3, 2, 0)])
@pytest.mark.parametrize("k", [0, 1, 40])
def test_models_without_states_inputs_or_outputs_respond(n: int, m: int, p: int, k: int) -> None:
    D = np.arange(float(p * m)).reshape(p, m)
    response = of((-np.eye(n), np.ones((n, m)), np.ones((p, n)), D)).response(1j * np.arange(k))
    np.testing.assert_array_equal(response, np.broadcast_to(D, (k, p, m)))


@pytest.mark.parametrize("point", [np.inf, np.nan, complex(0, np.inf)])
def test_points_are_finite(point: complex) -> None:
    with pytest.raises(SignalError, match="give finite ones; at infinity the response is D"):
        dense(3).response([1.0, point])


def test_the_poles_of_the_schur_form_are_those_of_the_model() -> None:
    model = dense(25)
    np.testing.assert_allclose(np.sort_complex(resolvent.schur(model.A).poles), model.poles, rtol=1e-12)
