"""What cannot be regulated is refused with the reason."""

import numpy as np
import pytest
import scipy.linalg

from synth.errors import ModelError
from synth.statespace import StateSpace
from synth.synthesise.regulation import regulator_equations
from synth.timing import Continuous, Discrete


def modes(*frequencies: float) -> tuple[regulator_equations.Mode, ...]:
    return tuple(regulator_equations.Mode(complex(0, w), 1) for w in frequencies)


def coupled_plant(scale: float = 1.0) -> StateSpace:
    """y1 = g (u1 + u2), y2 = g (u1 + u2) + (s^2 + 4) / (s + 1)^2 u2, g = 1 / (s + 1): y2 - y1 has a zero at 2 rad/s."""
    A = scipy.linalg.block_diag([[-1.0]], [[0.0, 1.0], [-1.0, -2.0]])
    B = [[1.0, 1.0], [0.0, 0.0], [0.0, 1.0]]
    C, D = [[1.0, 0.0, 0.0], [scale, 3.0 * scale, -2.0 * scale]], [[0.0, 0.0], [0.0, scale]]
    return StateSpace(A, B, C, D, ("a", "b", "c"), ("u1", "u2"), ("y1", "y2"), Continuous())


def test_a_zero_is_named_with_the_combination_that_no_input_moves() -> None:
    with pytest.raises(ModelError, match=r"zero at 2 rad/s, a frequency .* no input affects 1 y\d, -1\S* y\d; drop it"):
        regulator_equations.require_solvable(coupled_plant(), modes(0.0, 2.0))
    regulator_equations.require_solvable(coupled_plant(), modes(0.0, 2.01))


@pytest.mark.parametrize("scale", [1e-9, 1e9])
def test_units_do_not_move_zeros(scale: float) -> None:
    with pytest.raises(ModelError, match="transmission zero at 2 rad/s"):
        regulator_equations.require_solvable(coupled_plant(scale), modes(2.0))
    regulator_equations.require_solvable(coupled_plant(scale), modes(2.01))


def test_a_zero_is_found_in_sampled_plants_and_off_the_axis() -> None:
    z = np.exp(2j * 0.1)
    A, B, C = [[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], [[1.0, -2 * z.real]]
    sampled = StateSpace(A, B, C, [[1.0]], ("a", "b"), ("u",), ("y",), Discrete(0.1))  # 1 - 2 cos / z + 1 / z^2
    with pytest.raises(ModelError, match="transmission zero at 2 rad/s, a frequency"):
        regulator_equations.require_solvable(sampled, modes(2.0))
    regulator_equations.require_solvable(sampled, modes(1.9))
    right = StateSpace(
        [[-1.0]], [[1.0]], [[-1.5]], [[1.0]], ("a",), ("u",), ("y",), Continuous()
    )  # (s - 0.5) / (s + 1)
    with pytest.raises(ModelError, match=r"transmission zero at 0\.5 1/s, a mode"):
        regulator_equations.require_solvable(right, [regulator_equations.Mode(0.5 + 0j, 1)])
