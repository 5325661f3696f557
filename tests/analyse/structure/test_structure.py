"""Uncontrollable and unobservable modes are found, named and distinguished from weakly coupled ones."""

from dataclasses import replace

import control
import numpy as np
import pytest
import scipy.linalg
import slycot
from hypothesis import given, settings
from hypothesis import strategies as st

from synth.analyse.structure import realisation, staircase, structure
from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.timing import Continuous, Discrete
from tests import tolerances

CONTINUOUS, SAMPLED = Continuous(), Discrete(1e-3)


def state_names(n: int) -> tuple[str, ...]:
    return tuple(f"x{i}" for i in range(n))


def orthogonal(n: int, rng: np.random.Generator) -> np.ndarray:
    return np.linalg.qr(rng.normal(size=(n, n)))[0]


def test_an_oscillation_is_named_with_both_its_states() -> None:
    A = scipy.linalg.block_diag([[0.0, 2.0], [-2.0, 0.0]], [[-1.0]])
    with pytest.raises(ModelError, match=r"mode 0[+-]2i in (a, b|b, a) has") as caught:
        structure.require_stabilisable(A, [[0], [0], [1]], ("a", "b", "c"), ("u",), CONTINUOUS)
    assert "1e" not in str(caught.value).split("|w^H B| = ")[0]


@pytest.mark.parametrize(("value", "time"), [(-0.1, CONTINUOUS), (0.5, SAMPLED), (0.99, SAMPLED), (-0.99, SAMPLED)])
def test_a_mode_that_decays_needs_no_input(value: float, time: Continuous | Discrete) -> None:
    structure.require_stabilisable([[value]], [[0.0]], ("x",), ("u",), time)


@pytest.mark.parametrize(("value", "time"), [(0.0, CONTINUOUS), (0.1, CONTINUOUS), (1.0, SAMPLED), (-1.0, SAMPLED)])
def test_a_mode_that_does_not_decay_needs_one(value: float, time: Continuous | Discrete) -> None:
    with pytest.raises(ModelError, match="not stabilisable"):
        structure.require_stabilisable([[value]], [[0.0]], ("x",), ("u",), time)
    structure.require_stabilisable([[value]], [[1e-6]], ("x",), ("u",), time)


@pytest.mark.parametrize("seed", range(5))
def test_an_undriven_integrator_beside_driven_ones_is_found_in_any_coordinates(seed: int) -> None:
    """Computed eigenvalues of the three integrators scatter by 1e-8 and hide the undriven one."""
    U = orthogonal(3, np.random.default_rng(seed))
    A = U @ np.array([[0, 1, 0], [0, 0, 0], [0, 0, 0.0]]) @ U.T
    modes = structure.uncontrollable_modes(A, U @ [[0], [1], [0]], state_names(3), CONTINUOUS)
    assert [m.value for m in modes] == pytest.approx([0], abs=tolerances.of("double"))
    assert modes[0].measure < tolerances.of("double")
    assert not structure.uncontrollable_modes(A, U @ [[0, 0], [1, 0], [0, 1]], state_names(3), CONTINUOUS)


@settings(derandomize=True, max_examples=25, deadline=None)
@given(st.integers(0, 10**6))
def test_planted_uncontrollable_modes_are_found(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n, k, m = rng.integers(1, 5), rng.integers(0, 3), rng.integers(1, 3)
    planted = np.sort(rng.uniform(0.1, 3, k))
    A = np.block([[rng.normal(size=(n, n)), rng.normal(size=(n, k))], [np.zeros((k, n)), np.diag(planted)]])
    B = np.vstack([rng.normal(size=(n, m)), np.zeros((k, m))])
    U, units = orthogonal(n + k, rng), 10.0 ** rng.uniform(-3, 3, n + k)
    A, B = units[:, None] * (U @ A @ U.T) / units, units[:, None] * (U @ B)
    rates = sorted(mode.value.real for mode in structure.uncontrollable_modes(A, B, state_names(n + k), CONTINUOUS))
    assert rates == pytest.approx(list(planted), rel=1e-6)
    with_inputs = np.hstack([B, np.linalg.norm(A) * U[:, n:] * units[:, None]])
    assert not structure.uncontrollable_modes(A, with_inputs, state_names(n + k), CONTINUOUS)


def test_controllability_agrees_with_the_rank_of_the_controllability_matrix() -> None:
    rng = np.random.default_rng(3)
    for _ in range(20):
        A, B = rng.integers(-1, 2, (4, 4)).astype(float), rng.integers(-1, 2, (4, 1)).astype(float)
        out_of_reach = 4 - np.linalg.matrix_rank(control.ctrb(A, B))
        shifted = A + 10 * np.eye(4)  # no mode decays: each counts
        assert len(structure.uncontrollable_modes(shifted, B, state_names(4), CONTINUOUS)) == out_of_reach


def system(A: object, B: object, C: object) -> StateSpace:
    A, B, C = (np.asarray(M, float) for M in (A, B, C))
    inputs, outputs = tuple(f"u{i}" for i in range(B.shape[1])), tuple(f"y{i}" for i in range(len(C)))
    return StateSpace(A, B, C, np.zeros((len(C), B.shape[1])), state_names(len(A)), inputs, outputs, CONTINUOUS)


def test_transmission_zeros_do_not_depend_on_units() -> None:
    w, A = 7.0, [[0, 1, 0], [0, 0, 1], [-1, -3, -3]]
    for scale in (1e-9, 1.0, 1e9):
        plant = system(A, [[0], [0], [scale]], [[w * w * 1e-6, 0, 1e-6]])  # numerator s^2 + w^2
        assert sorted(abs(control.zeros(plant.to_control()))) == pytest.approx([w, w])
        assert nearest(structure.transmission_zeros(plant).values, np.array([w * 1j, -w * 1j])) < 1e-9 * w


def test_unconnected_states_are_removed_and_the_response_stays() -> None:
    A = np.array([[-1.0, 0, 0, 0], [1, -2, 0, 0], [0, 0, -3, 0], [0, 1, 0, -4]])
    whole = system(A, [[1], [0], [0], [0]], [[0, 1, 1, 0]])
    part = realisation.without_unconnected_states(whole)
    s = 1j * np.array([0.1, 1, 10])
    assert part.states == ("x0", "x1")
    np.testing.assert_allclose(part.response(s), whole.response(s), rtol=tolerances.of("double"))
    through = realisation.without_unconnected_states(system([[-1.0]], [[0]], [[1]]))
    assert through.states == () and not through.response(s).any()


def in_units(model: StateSpace, seed: int, decades: float = 3) -> StateSpace:
    """Return the same model with its states, inputs and outputs in other units, up to 10^decades apart."""
    rng = np.random.default_rng(seed)
    x, u, y = (10.0 ** rng.uniform(-decades, decades, k) for k in (*model.B.shape, len(model.C)))
    A, B, C, D = model.A / x[:, None] * x, model.B / x[:, None] * u, model.C / y[:, None] * x, model.D / y[:, None] * u
    return StateSpace(A, B, C, D, model.states, model.inputs, model.outputs, model.time)


def rotated(model: StateSpace, seed: int) -> StateSpace:
    U = orthogonal(len(model.A), np.random.default_rng(seed))
    return StateSpace(
        U @ model.A @ U.T, U @ model.B, model.C @ U.T, model.D, model.states, model.inputs, model.outputs, model.time
    )


def random_model(seed: int) -> StateSpace:
    """Return a random model, with direct term zero, of rank 1 or full, and sometimes with chains of integrators."""
    rng = np.random.default_rng(seed)
    n, m, p = rng.integers(2, 7), rng.integers(1, 4), rng.integers(1, 4)
    D = [np.zeros((p, m)), rng.normal(size=(p, 1)) @ rng.normal(size=(1, m)), rng.normal(size=(p, m))][seed % 3]
    A = np.diag(np.ones(n - 1), 1) if seed % 4 == 1 else rng.normal(size=(n, n))
    plain = system(A, rng.normal(size=(n, m)), rng.normal(size=(p, n)))
    return StateSpace(plain.A, plain.B, plain.C, D, plain.states, plain.inputs, plain.outputs, CONTINUOUS)


def nearest(roots: np.ndarray, reference: np.ndarray) -> float:
    """Return the largest distance of a pairing by size, relative to the largest value or 1."""
    assert len(roots) == len(reference)
    left = list(roots)
    worst = 0.0
    for w in reference:
        k = int(np.argmin(np.abs(np.array(left) - w)))
        worst = max(worst, abs(left.pop(k) - w))
    return worst / max(1.0, float(np.abs(reference).max(initial=0.0)))


@settings(derandomize=True, max_examples=60, deadline=None)
@given(st.integers(0, 10**6))
def test_transmission_zeros_are_those_of_slicot_in_any_units(seed: int) -> None:
    model = random_model(seed)
    reference, rank = slicot_zeros(model)
    zeros = structure.transmission_zeros(in_units(model, seed))
    assert nearest(zeros.values, reference) < tolerances.of("zeros")
    assert zeros.rank == rank and not zeros.uncontrollable and not zeros.unobservable


def slicot_zeros(model: StateSpace) -> tuple[np.ndarray, int]:
    """Return the finite generalised eigenvalues of the pencil that SLICOT's AB08ND deflates to, and its rank."""
    n, m, p = len(model.A), model.B.shape[1], len(model.C)
    big = max(n, m, p)
    room = max(8, big * (big + 4) + 3 * big + 8 * big)
    nu, rank, *_, Af, Bf = slycot.ab08nd(n, m, p, model.A, model.B, model.C, model.D, ldwork=room)[:10]
    return scipy.linalg.eigvals(Af[:nu, :nu], Bf[:nu, :nu]), rank


def planted_zeros(zeros: list[float], seed: int) -> StateSpace:
    """Return two channels with numerators (s - z) over (s + 1)(s + 2), mixed at inputs and outputs by regular M, N."""
    rng = np.random.default_rng(seed)
    channels = [([[0, 1], [-2, -3]], [[0], [1]], [[-z, 1]]) for z in zeros]
    A, B, C = (scipy.linalg.block_diag(*parts) for parts in zip(*channels, strict=True))
    M, N = (np.eye(2) + 0.4 * rng.uniform(-1, 1, (2, 2)) for _ in range(2))
    return rotated(system(A, B @ M, N @ C), seed)


@pytest.mark.parametrize("zeros", [[3.0, -0.5], [1e4, -1e-3], [2.0, 2.0]])
def test_planted_zeros_are_found_with_directions(zeros: list[float]) -> None:
    model = planted_zeros(zeros, 1)
    computed = structure.transmission_zeros(model)
    np.testing.assert_allclose(sorted(computed.values.real), sorted(zeros), rtol=1e-9)
    for root in computed.roots:
        G = model.response(root.value)[0]
        u = np.array([root.inputs.get(name, 0.0) for name in model.inputs])
        if len(root.inputs) == 2 and zeros[0] != zeros[1]:  # no component was omitted: the inputs as scaled
            u = staircase.of_model(model).u * u
            quiet = np.linalg.svd(G)[2][-1].conj()
            assert abs(np.vdot(quiet, u)) / np.linalg.norm(u) == pytest.approx(1, abs=1e-6), "given to six digits"


@pytest.mark.parametrize("seed", range(5))
def test_a_chain_of_integrations_has_no_spurious_zeros_unlike_the_bare_pencil(seed: int) -> None:
    """A force reaches the output after three integrations: the pencil has four infinite roots in one chain.

    Whether rounding makes three of them finite depends on the processor. A direct term of ten roundings stands for
    it: the bare pencil then has the roots of 1e-15 s^3 = -1 beside the zero, to leading order, on every processor.
    """
    late = system([[0, 1, 0, 0], [0, 0, 1, 0], [-3, 1, -2, 1], [1, 0, 1, -5]], np.eye(4, 1, -2), np.eye(1, 4))
    chain = rotated(replace(late, D=[[1e-15]]), seed)
    (root,) = structure.transmission_zeros(chain).roots
    assert root.value == pytest.approx(-5)
    pencil = np.block([[chain.A, chain.B], [chain.C, chain.D]])
    bare = scipy.linalg.eigvals(pencil, scipy.linalg.block_diag(np.eye(4), 0))
    assert (np.abs(bare[np.isfinite(bare)]) > 1e3).any(), "planted: what deflation is for"


def test_uncontrollable_and_unobservable_modes_are_not_zeros_and_are_named() -> None:
    A = np.diag([-1.0, -2.0, -3.0, -4.0])
    model = system(A, [[1], [1], [0], [1]], [[1, 1, 1, 0]])
    zeros = structure.transmission_zeros(model)
    assert zeros.values == pytest.approx([-1.5])
    assert [(m.value, m.states) for m in zeros.uncontrollable] == [(-3, ("x2",))]
    assert [(m.value, m.states) for m in zeros.unobservable] == [(-4, ("x3",))]
    assert "Uncontrollable mode -3 in x2." in str(zeros) and "Unobservable mode -4 in x3." in str(zeros)
    assert nearest(control.zeros(model.to_control()), np.array([-1.5, -3, -4])) < 1e-9, "the invariant zeros"


def test_fewer_outputs_than_inputs_give_the_direction_of_the_outputs() -> None:
    A, B, C = np.diag([-1.0, -2.0, -3.0]), np.array([[1.0, 1.0], [1.0, 2.0], [1.0, 0.0]]), [[1.0, 0.0, 0.0]]
    free = structure.transmission_zeros(system(A, B, C))
    assert not free.roots and free.rank == 1
    blocked = system(
        scipy.linalg.block_diag([[0, 1], [-2, -3]], -5), [[0, 0], [1, 2], [1, 0]], [[-3.0, 1, 0]]
    )  # both inputs pass through s - 3
    (root,) = structure.transmission_zeros(blocked).roots
    assert root.value == pytest.approx(3) and dict(root.outputs) == {"y0": 1} and not root.inputs


def test_a_response_without_full_rank_says_so() -> None:
    twice = system(np.diag([-1.0, -2.0]), np.eye(2), [[1, 1], [2, 2]])
    zeros = structure.transmission_zeros(twice)
    assert zeros.rank == 1 and "rank 1 at every s though it has 2 outputs and 2 inputs" in str(zeros)
    assert all(not (r.states or r.inputs or r.outputs) for r in zeros.roots)


def test_poles_print_damping_frequency_and_states_in_any_units() -> None:
    w = 2 * np.pi * 100
    model = system([[0, 1, 0], [-w * w, -0.02 * w, 0], [0, 0, 0]], [[0], [1], [1]], [[1, 0, 1]])
    for seed in range(4):
        poles = structure.poles(in_units(model, seed))
        rest, one, other = poles.roots
        assert rest.value == 0 and np.isnan(rest.damping) and tuple(rest.states) == ("x2",)
        assert one.value == pytest.approx(other.value.conjugate())
        assert one.damping == pytest.approx(0.01) and one.frequency == pytest.approx(100)
        assert set(one.states) == {"x0", "x1"}
    assert str(poles).splitlines()[1].split() == ["pole", "damping", "frequency", "[Hz]", "states"]
    assert str(poles).splitlines()[3].startswith("-6.2832 +- 628.29i     0.01             100")


def test_sampled_poles_have_the_damping_of_their_continuous_equivalent() -> None:
    s, T = -3 + 40j, SAMPLED.period_s
    z = np.exp(s * T)
    roots = structure.poles(([[z.real, z.imag], [-z.imag, z.real]], np.eye(2), SAMPLED)).roots
    assert [r.frequency for r in roots] == pytest.approx([abs(s) / (2 * np.pi)] * 2)
    assert roots[0].damping == pytest.approx(3 / abs(s))
    (dead,) = structure.poles(([[0.0]], [[1.0]], SAMPLED)).roots
    assert dead.frequency == np.inf and dead.damping == 1


@pytest.mark.parametrize("seed", range(6))
def test_a_verdict_on_the_modes_is_the_same_in_metres_and_in_millimetres(seed: int) -> None:
    A = [[0, 1, 0, 0], [-4, 0, 1, 0], [0, 0, 0, 1], [0, 0, 2, 0]]
    good, bad = system(A, [[0], [1], [0], [1]], np.eye(4)), system(A, [[0], [1], [0], [0]], np.eye(4))
    structure.check_stabilisable(in_units(good, seed))
    with pytest.raises(ModelError, match=r"mode [-+0-9.]+ in x[23], x[23] has .*; its direction is 1 x[23], ") as one:
        structure.check_stabilisable(bad)
    with pytest.raises(ModelError) as other:
        structure.check_stabilisable(in_units(bad, seed))
    assert mode_and_states(one) == mode_and_states(other)
    unseen_model = in_units(unseen(), seed)
    pair = unseen_model.A, unseen_model.C, unseen_model.states
    with pytest.raises(ModelError, match=r"\(y0, A\) is not detectable: mode 1\.414 in x[23], x[23] has"):
        structure.require_detectable(*pair, "y0", unseen_model.time)


def mode_and_states(caught: pytest.ExceptionInfo[ModelError]) -> tuple[str, set[str]]:
    words = str(caught.value).split(": ")[1].split(" has ")[0].removeprefix("mode ").split(" in ")
    return words[0], set(words[1].split(", "))


def unseen() -> StateSpace:
    A = [[0, 1, 0, 0], [-4, 0, 0, 0], [0, 0, 0, 1], [1, 0, 2, 0]]
    return system(A, np.eye(4), [[1, 0, 0, 0]])
