"""The maglev controller's NumPy reference against closed forms, SciPy, the full plant and the published poles.

The full plant is the reference's own F(6)-(7); F(11) is taken from it by differences, which are exact for a quadratic.
"""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from functools import cache
from math import asin, cos, exp, pi, sin, sqrt

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy import linalg, signal

from designs.maglev import reference_stage
from designs.maglev_5dof import reference, reference_gains
from synth.reference.guard import rows
from tests.designs.maglev_5dof import full_plant

Array = NDArray[np.float64]
P = reference_stage.Parameters()
T = 1e-3
# Largest |error|: |s| stays below twice that over 1 - 1/e, and |r| below twice that over 1 - 2/e.
ERRORS = {"y": 0.0165, "x": 0.15, "z": 0.15, "phi": 0.023, "theta": 0.045}
ODE = {"y": 1, "phi": 7, "theta": 9}  # rows of the plant's derivative


def inputs(n: int = 1, **changes: object) -> dict[str, Array]:
    """Return n good samples: the platen level at 25 mm, set-points where it is."""
    at = {f"y{j}": 0.025 for j in range(1, 5)} | {"x": 0.0, "z": 0.0, "y_ref": 0.025}
    at |= dict.fromkeys(("x_ref", "z_ref", "phi_ref", "theta_ref"), 0.0)
    return {name: np.full(n, changes.get(name, value)) for name, value in at.items()}


def start(n: int = 1, **changes: float) -> dict[str, Array]:
    return {name: np.full(n, changes.get(name, value)) for name, value in full_plant.initial_state().items()}


def any_state(rng: np.random.Generator, n: int) -> dict[str, Array]:
    """Return n states anywhere in their bounds, ready and not latched."""
    state = start(n, guard_ready=1)
    for s, widest in ERRORS.items():
        state[f"filter_{s}_q_prev"] = rng.uniform(-1, 1, n) * widest
        state[f"filter_{s}_s"] = rng.uniform(-1, 1, n) * 2 * widest / (1 - exp(-1))
        state[f"filter_{s}_r"] = rng.uniform(-1, 1, n) * 2 * widest / (1 - 2 * exp(-1))
        bounds = zip(reference.ETA, reference.ETA_BOUNDS, strict=True)
        state |= {f"regulator_{s}_{name}": rng.uniform(-b, b, n) for name, b in bounds}
    for s in reference_stage.SAFE:
        state[f"safe_output_last_{s}"] = rng.uniform(-4.9, 4.9, n)
    return state


def any_inputs(rng: np.random.Generator, n: int) -> dict[str, Array]:
    return {s: rng.uniform(low, high, n) for s, (low, high) in reference_stage.LIMITS.items()}


class TestMotor:
    # gap m: F0 N, dF_V/di_d N/A, F_H per A in N/A, each from a separate evaluation of F(2)-(4)
    TABLE = ((0.018, 60.423, 21.730, 18.519), (0.025, 25.937, 13.446, 12.488), (0.031, 13.040, 9.3391, 8.9890))

    @staticmethod
    def worst(parameters: reference_stage.Parameters) -> float:
        errors = []
        for gap, *expected in TestMotor.TABLE:
            m = reference_stage.motor(np.array(gap), parameters)
            errors += [
                abs(coefficient / value - 1) for coefficient, value in zip((m.a, m.b, m.h), expected, strict=True)
            ]
        return float(max(errors))

    def test_forces(self) -> None:
        assert self.worst(P) < 6e-5

    def test_forces_come_from_one_field(self) -> None:
        """With csch^2 in c, b^2 = 4 a c cosh^2 and h = b tanh."""
        g = np.linspace(0.0124, 0.0366, 50)
        m, x = reference_stage.motor(g, P), pi / P.tau * (P.h_m + g)
        np.testing.assert_allclose(m.b**2, 4 * m.a * m.c * np.cosh(x) ** 2, rtol=1e-13)
        np.testing.assert_allclose(m.h, m.b * np.tanh(x), rtol=1e-13)

    def test_quadratic_attraction_of_finite_differences(self) -> None:
        """0.11962 N per A^2 of phase peak at 25 mm with real slots."""
        assert reference_stage.motor(np.array(0.025), P).c / 2 == pytest.approx(0.11962, rel=2e-3)


# F section IV-A: printed closed-loop poles, to their last digit
POLES = {
    "y": (-173.2, -2.61 + 5.48j, -2.16 + 1.77j),
    "x": (-38.73, -3.2 + 5.89j, -2.69 + 2.23j),
    "theta": (-200, -2.81 + 5.58j, -2.19 + 1.82j),
}
DIGITS = {"y": (0.1, 0.01, 0.01), "x": (0.01, 0.02, 0.01), "theta": (0.1, 0.01, 0.01)}


# K of (e, e', xi1, xi2, xi3) from a Riccati solution made apart from this one
GAINS = {
    "y": (-1699.7, -182.75, -50000.0, 2725.5, -7806.8),
    "x": (-525.33, -50.504, -21213.0, -1253.6, -2742.2),
    "theta": (-2050.0, -210.00, -63246.0, 1910.6, -9901.3),
}


@cache
def gain(axis: str) -> Array:
    """Return K on (e, e', xi)."""
    return reference_gains.gain(reference.WEIGHTS[axis])


A, B = np.eye(5, k=1), np.eye(5)[:, [1]]  # of (e, e', xi1, xi2, xi3) under w, F(13)-(15)
A[1, 2], A[4, 0], A[4, 3] = 0, 1, -(reference_gains.OMEGA0**2)


class TestGains:
    @staticmethod
    def poles(K: Array) -> Array:
        values = np.linalg.eigvals(A + B @ K[None, :])
        upper = values[values.imag >= 0]
        return upper[np.argsort(upper.real)]

    @pytest.mark.parametrize("axis", ["y", "x", "theta"])
    def test_published_poles(self, axis: str) -> None:
        error = np.abs(self.poles(gain(axis)) - np.array(POLES[axis]))
        assert np.all(error < DIGITS[axis])

    @pytest.mark.parametrize("axis", ["y", "x", "theta"])
    def test_digits(self, axis: str) -> None:
        np.testing.assert_allclose(gain(axis), GAINS[axis], rtol=3e-5)

    @pytest.mark.parametrize("axis", reference_stage.AXES)
    def test_first_internal_gain_is_a_square_root(self, axis: str) -> None:
        """p(s) p(-s) = d(s) d(-s) + sum q_i n_i(s) n_i(-s) at s = 0 gives K_3^2 = q_3, to the last bit."""
        assert gain(axis)[2] == -sqrt(reference.WEIGHTS[axis][2])

    @pytest.mark.parametrize("axis", reference_stage.AXES)
    def test_gains_solve_the_riccati_equation(self, axis: str) -> None:
        """SciPy's solution, made better by Newton-Kleinman steps on residuals in exact arithmetic."""
        Q = np.diag(reference.WEIGHTS[axis])
        X = linalg.solve_continuous_are(A, B, Q, np.eye(1))
        exact = np.vectorize(Fraction, otypes=[object])
        X, F, G = exact((X + X.T) / 2), exact(A), exact(B)
        F[4, 3] = -(Fraction(reference_gains.OMEGA0) ** 2)
        for _ in range(4):
            residual = F.T.dot(X) + X.dot(F) - X.dot(G).dot(G.T).dot(X) + exact(Q)
            closed = A - B @ B.T @ X.astype(float)
            D = exact(linalg.solve_continuous_lyapunov(closed.T, -residual.astype(float)))
            X = X + (D + D.T) / 2
        np.testing.assert_array_equal(gain(axis), -G.T.dot(X)[0].astype(float))


class TestDiscretisation:
    @staticmethod
    def sampled() -> tuple[Array, Array, Array]:
        """Return exp(Phi T) and the integrals of it with N and with E, in closed form."""
        o, a = reference_gains.OMEGA0, 7e-5
        s, c = sin(o * T), cos(o * T)
        Phi = np.array([[1, s / o, (1 - c) / o**2], [0, c, s / o], [0, -o * s, c]])
        N = np.array([(o * T - s) / o**3, (1 - c) / o**2, s / o])
        E = N + np.array([T + (1 - c) / o**2, s / o, c - 1])  # (0, 0, 1) as N, and (1, 1, 0)
        return Phi, N, a * E

    def test_internal_model(self) -> None:
        """One sample in eta, written by `model_step` from each unit vector, is that in xi = T eta."""
        Phi, N, E = self.sampled()
        k, to_xi = reference.constants(), np.array(reference_gains.internal_model().T.tolist(), dtype=float)

        def after(eta: Array, e: float, excess: float) -> Array:
            return np.array(reference.model_step(np.array(e), np.array(excess), eta, k))

        A, zero = np.column_stack([after(unit, 0, 0) for unit in np.eye(3)]), np.zeros(3)
        np.testing.assert_allclose(to_xi @ A @ np.linalg.inv(to_xi), Phi, rtol=1e-9, atol=1e-10)
        np.testing.assert_allclose(to_xi @ after(zero, 1, 0), N, rtol=1e-8)
        np.testing.assert_allclose(to_xi @ after(zero, 0, 1), E, rtol=1e-8)
        assert k.c == pytest.approx((2 * sin(reference_gains.OMEGA0 * T / 2)) ** 2, rel=1e-15)

    @pytest.mark.parametrize("axis", reference_stage.AXES)
    def test_the_gain_on_eta_is_that_on_xi(self, axis: str) -> None:
        K = reference.constants().K[reference_stage.AXES.index(axis)]
        to_xi = np.array(reference_gains.internal_model().T.tolist(), dtype=float)
        np.testing.assert_array_equal(K[:2], gain(axis)[:2])
        np.testing.assert_allclose(np.linalg.solve(to_xi.T, K[2:]), gain(axis)[2:], rtol=1e-9)

    def test_a_model_at_its_bounds_stands_still_by_state(self) -> None:
        k, (total, p, q) = reference.constants(), reference.ETA_BOUNDS
        eta = np.array([total, 0.999 * p, 0.5 * q])
        moved = np.array(reference.model_step(np.array(0.01), np.array(0.0), eta, k)) - eta
        turned = 0.999 * p + k.c * 0.5 * q
        assert turned > p and [*moved[:2]] == [0, 0] and moved[2] == pytest.approx(0.01 - turned, rel=1e-12)

    def test_filter_is_exact_on_ramps_between_samples(self) -> None:
        """Against SciPy's first-order hold of s w^2 / (s + w)^2 on a random signal."""
        rng = np.random.default_rng(1)
        q = np.concatenate([[0.0], rng.uniform(-1e-3, 1e-3, 200)])
        w = reference_gains.FILTER
        b, a, _ = signal.cont2discrete(([w**2, 0.0], [1.0, 2.0 * w, w**2]), T, method="foh")
        expected = signal.lfilter(b.ravel(), a, q)
        memory, rates = np.zeros(3), []
        for value in q:
            v, memory = reference.rate(value, memory, np.array(True), reference.constants())
            rates.append(v)
        np.testing.assert_allclose(rates, expected, atol=1e-11)
        held, a, _ = signal.cont2discrete(([w**2, 0.0], [1.0, 2.0 * w, w**2]), T, method="zoh")
        assert np.max(np.abs(signal.lfilter(held.ravel(), a, q) - expected)) > 1e-2

    def test_filter_coefficients(self) -> None:
        """H(z) = h (1 + rho/z) (1 - 1/z) / (1 - fade/z)^2 is SciPy's first-order hold."""
        fade, rho, h = reference.constants().filter
        w = reference_gains.FILTER
        b, a, _ = signal.cont2discrete(([w**2, 0.0], [1.0, 2.0 * w, w**2]), T, method="foh")
        np.testing.assert_allclose(h * np.polymul([1, rho], [1, -1]), b.ravel(), rtol=1e-12)
        np.testing.assert_allclose(np.polymul([1, -fade], [1, -fade]), a, rtol=1e-12)
        assert fade == exp(-1) and h == pytest.approx((1 - 2 * exp(-1)) / T, rel=1e-15)

    def test_a_steady_ramp_gives_its_slope(self) -> None:
        memory = np.zeros(3)
        for n in range(60):
            v, memory = reference.rate(np.array(0.5e-3 * n), memory, np.array(True), reference.constants())
        assert v == pytest.approx(0.5, rel=1e-12)


class TestGuard:
    def test_ranges(self) -> None:
        """Motor gaps over the box of gap and angles; twice the stroke; the box less 50 um at a motor."""
        assert reference_stage.LIMITS == {
            "y1": (0.0168, 0.0322),
            "y2": (0.0124, 0.0366),
            "y3": (0.0168, 0.0322),
            "y4": (0.0124, 0.0366),
            "x": (-0.1, 0.1),
            "z": (-0.1, 0.1),
            "y_ref": (0.018 + 50e-6, 0.031 - 50e-6),
            "x_ref": (-0.05 + 50e-6, 0.05 - 50e-6),
            "z_ref": (-0.05 + 50e-6, 0.05 - 50e-6),
            "phi_ref": (-0.003 + 50e-6 / 0.397, 0.003 - 50e-6 / 0.397),
            "theta_ref": (-0.014 + 50e-6 / 0.397, 0.014 - 50e-6 / 0.397),
        }

    def test_no_kick_before_the_first_good_sample(self) -> None:
        """The filter rests until every measurement was good at once, then sees the next difference."""
        state, _, _ = reference.step(start(), inputs(y_ref=0.020))
        assert state["filter_y_r"] == state["filter_y_s"] == 0.0
        state, _, _ = reference.step(state, inputs(y_ref=0.021))
        assert state["filter_y_r"][0] == state["filter_y_s"][0] == pytest.approx(-1e-3, rel=1e-12)


@pytest.fixture(scope="module")
def samples() -> tuple[dict[str, Array], dict[str, Array]]:
    """Return poses in the box of the stage and moderate demands."""
    rng = np.random.default_rng(2)
    bounds = {"y": 3.0, "x": 2.0, "z": 2.0, "phi": 10.0, "theta": 10.0}
    q = {s: rng.uniform(*reference_stage.BOX[s], 2000) for s in ODE}
    return q, {s: rng.uniform(-b, b, 2000) for s, b in bounds.items()}


class TestLaw:
    @staticmethod
    def at(y: Array, phi: Array, theta: Array, u: Array) -> Array:
        x = np.zeros((10, *y.shape))
        x[0], x[6], x[8] = y, phi, theta
        return full_plant.plant(x, u, P)

    @staticmethod
    def by_8(v: Array) -> Array:
        y, phi, theta = v
        return np.stack([y + phi, y - theta, y - phi, y + theta]) / 2

    def printed(self, q: dict[str, Array], w: dict[str, Array], u: Array) -> Array:
        """Return i_d by F(12) as printed, its coefficients differenced from the full plant at i_q = u (4, n)."""

        def accelerations(v: Array) -> Array:
            derivative = self.at(q["y"], q["phi"], q["theta"], np.concatenate([self.by_8(v), u]))
            return derivative[list(ODE.values())]

        zero = np.zeros((3, u.shape[1]))
        unit = np.eye(3)[:, :, None] + zero[None]
        D = np.stack([(accelerations(e) - accelerations(-e)) / 2 for e in unit], axis=1)
        missing = np.stack([w[s] for s in ODE]) - accelerations(zero)
        return self.by_8(np.linalg.solve(D.transpose(2, 0, 1), missing.T[:, :, None])[:, :, 0].T)

    @staticmethod
    def gaps(q: dict[str, Array], warp: float = 0.0) -> Array:
        """Return the four gaps (4, n) of a pose, with a `warp` in m that no rigid platen has."""
        tilt, roll = P.r * np.sin(q["phi"]), P.r * np.sin(q["theta"])
        at = [q["y"] - tilt + warp, q["y"] + roll - warp, q["y"] + tilt + warp, q["y"] - roll - warp]
        return np.stack(at)

    def currents(
        self, w: dict[str, Array], q: dict[str, Array], gaps: Array, before: Array, k: reference.Constants
    ) -> tuple[Array, Array]:
        """Return the currents (6, n) and what the limits add to those of the axes (5, n), for columns by axis."""
        flat = {s: np.zeros_like(q["y"]) for s in reference_stage.AXES} | q
        both = (rows(columns, reference_stage.AXES) for columns in (w, flat))
        return reference.currents(*both, gaps, before, k)

    @staticmethod
    def stacked(out: Array) -> Array:
        """Return i_d1..i_d4, i_q1..i_q4 (8, n) of the currents i_d1..i_d4, u_x, u_z (6, n)."""
        return out[[0, 1, 2, 3, 5, 4, 5, 4]]

    def test_as_printed(self, samples: tuple[dict[str, Array], dict[str, Array]]) -> None:
        q, w = samples
        rng = np.random.default_rng(7)
        before = rng.uniform(-3, 3, (len(q["y"]), 6)).T
        out, _ = self.currents(w, q, self.gaps(q), before, reference.constants(corrected=False))
        i_d, i_q = self.stacked(out)[:4], self.stacked(before)[4:]
        free = np.max(np.abs(i_d), axis=0) < 0.99 * reference_stage.CURRENT
        assert np.mean(free) > 0.5
        expected = self.printed(q, w, i_q)
        np.testing.assert_allclose(i_d[:, free], expected[:, free], atol=1e-11)
        assert np.max(np.abs(i_d[:, free] - self.printed(q, w, 0 * i_q)[:, free])) > 1e-3

    def reached(self, samples: tuple[dict[str, Array], dict[str, Array]], corrected: bool) -> Callable[[str], Array]:
        """Return the errors in acceleration of the full plant, but for what is left of the springs, off the limits.

        The pose and the demands stand still until the currents do.
        """
        q, w = samples
        out = np.tile([*reference_stage.SAFE.values()], (len(q["y"]), 1)).T
        for _ in range(40):
            out, excess = self.currents(w, q, self.gaps(q), out, reference.constants(corrected=corrected))
        u = self.stacked(out)
        free = (np.max(np.abs(u), axis=0) < 0.9 * reference_stage.CURRENT) & (excess == 0).all(axis=0)
        assert np.mean(free) > 0.5
        derivative = self.at(q["y"], q["phi"], q["theta"], u)
        for row, axis, k_s in ((7, "phi", P.k_s_phi), (9, "theta", P.k_s_theta)):
            derivative[row] += (1 - reference_stage.COMPENSATED[axis] if corrected else 0) * k_s * q[axis]
        rows = ODE | {"x": 3, "z": 5}
        return lambda s: np.abs(derivative[rows[s]] - w[s])[free]

    def test_double_integrators(self, samples: tuple[dict[str, Array], dict[str, Array]]) -> None:
        """F(13): x and z obey it exactly, y, phi and theta too where the law is corrected, else but for i_d^2."""
        corrected, printed = self.reached(samples, True), self.reached(samples, False)
        for s in ("x", "z"):
            assert np.max(corrected(s)) < 1e-12
        for s in ODE:
            assert np.max(corrected(s)) < 1e-10
        assert np.mean(printed("y")) > 1e-2

    def test_currents_of_the_sample_before_leave_an_error_of_their_change(
        self, samples: tuple[dict[str, Array], dict[str, Array]]
    ) -> None:
        """Sum_j c_j (|i_j|^2 - |i_j before|^2) / M_y, downwards."""
        q, w = samples
        k, rng = reference.constants(), np.random.default_rng(8)
        before = rng.uniform(-1, 1, (len(q["y"]), 6)).T
        out, _ = self.currents(w, q, self.gaps(q), before, k)
        u, v = self.stacked(out), self.stacked(before)
        free = np.max(np.abs(u), axis=0) < 0.9 * reference_stage.CURRENT
        change = u[:4] ** 2 + u[4:] ** 2 - v[:4] ** 2 - v[4:] ** 2
        c = full_plant.motors(q["y"], q["phi"], q["theta"], P).c
        error = self.at(q["y"], q["phi"], q["theta"], u)[ODE["y"]] - w["y"]
        np.testing.assert_allclose(error[free], -(np.sum(c * change, axis=0) / P.M_y)[free], atol=1e-11)

    def test_each_motor_is_taken_at_its_own_gap(self) -> None:
        """A warp, of which the pose tells nothing, changes the currents; so do gaps past the box of the stage."""
        w = {s: np.array(0.5) for s in reference_stage.AXES}
        before, k = np.array([*reference_stage.SAFE.values()]), reference.constants()
        q = {"y": np.array(0.018), "phi": np.array(0.003), "theta": np.array(-0.014)}
        past = {"y": np.array(0.0172), "phi": np.array(0.0031), "theta": np.array(-0.0141)}
        currents = [
            self.currents(w, q, self.gaps(at, warp), before, k)[0] for at, warp in ((q, 0), (q, 5e-4), (past, 0))
        ]
        assert all(abs(currents[0][0] - other[0]) > 1e-2 for other in currents[1:])

    @pytest.mark.parametrize("corrected", [True, False])
    def test_motor_limit(self, corrected: bool) -> None:
        rng, n = np.random.default_rng(3), 20_000
        state, out, _ = reference.step(any_state(rng, n), any_inputs(rng, n), reference.constants(corrected=corrected))
        rms = np.max([np.hypot(out[f"i_d{j}"], out[f"i_q{j}"]) for j in range(1, 5)], axis=0)
        assert np.all(rms <= 7 / sqrt(2) * (1 + 1e-15))
        assert np.mean(rms > 4.949) > 0.5
        for s, widest in ERRORS.items():
            bounds = {"q_prev": widest, "s": 2 * widest / (1 - exp(-1)), "r": 2 * widest / (1 - 2 * exp(-1))}
            for part, bound in bounds.items():
                assert np.all(np.abs(state[f"filter_{s}_{part}"]) <= bound * (1 + 1e-14))
            for name, bound in zip(reference.ETA, reference.ETA_BOUNDS, strict=True):
                assert np.all(np.abs(state[f"regulator_{s}_{name}"]) <= bound)

    def test_anti_windup(self) -> None:
        """A demand past the limit moves xi = T eta by E (u limited - u demanded), and only then."""
        k = reference.constants()
        bare = replace(k, E=np.zeros(3))
        state = start(2, guard_ready=1) | {"filter_x_q_prev": np.array([0.001, 0.08])}
        at = inputs(2) | {"x": np.array([0.001, 0.08])}
        after, out, _ = reference.step(state, at, k)
        without, _, _ = reference.step(state, at, bare)
        memory = np.array([state["filter_x_q_prev"], np.zeros(2), np.zeros(2)])
        v, _ = reference.rate(at["x"], memory, np.array(True), k)
        w = k.K[1, 0] * at["x"] + k.K[1, 1] * v
        m = reference_stage.motor(np.array(0.025), P)
        excess = out["i_q2"] + P.M_x * w / (2 * m.h)
        assert excess[0] == pytest.approx(0, abs=1e-12)
        assert abs(excess[1]) > 1
        moved = np.array([after[f"regulator_x_{n}"] - without[f"regulator_x_{n}"] for n in reference.ETA])
        to_xi, E = np.array(reference_gains.internal_model().T.tolist(), dtype=float), TestDiscretisation.sampled()[2]
        np.testing.assert_allclose(to_xi @ moved, E[:, None] * excess, rtol=1e-8, atol=1e-15)


def test_kinematics_invert_5() -> None:
    at = {"y": 0.024, "phi": 0.0025, "theta": -0.012}
    tilt, roll = P.r * sin(at["phi"]), P.r * sin(at["theta"])
    v = np.array([at["y"] - tilt, at["y"] + roll, at["y"] + tilt, at["y"] - roll, 0.01, 0.02])
    y, x, z, phi, theta = reference_stage.pose(v, P.r)
    pose = {"y": y, "x": x, "z": z, "phi": phi, "theta": theta}
    assert pose == pytest.approx(at | {"x": 0.01, "z": 0.02}, abs=1e-16)
    assert phi == pytest.approx(asin(tilt / P.r), rel=1e-12)


def test_scalars_and_columns_agree() -> None:
    rng, n = np.random.default_rng(4), 5
    state, at = any_state(rng, n), any_inputs(rng, n)
    at["y1"][2] = np.nan
    after, out, word = reference.step(state, at)
    for j in range(n):
        one = reference.step({s: v[j] for s, v in state.items()}, {s: v[j] for s, v in at.items()})
        np.testing.assert_allclose([one[0][s] for s in after], [v[j] for v in after.values()], rtol=1e-13, atol=1e-15)
        np.testing.assert_allclose([one[1][s] for s in out], [v[j] for v in out.values()], rtol=1e-13, atol=1e-15)
        assert one[2] == word[j]
