"""Arguments of the estimators: lists become tuples; invalid numbers, places and times are refused by name."""

from typing import Any

import numpy as np
import pytest

from designs.hall_position import config
from designs.hall_position.glsdc import channels, estimator
from designs.hall_position.glsdc.parameters import Tuning
from designs.hall_position.protected import config as protected
from models.hall_two_waves import PlanarArray as Array
from models.hall_two_waves import SpatialArray
from synth.errors import DesignError, ModelError, TimingError
from synth.timing import Continuous

PLACES = ((0.0, 0.0), (0.01, 0.02))
SIX_PLACES = ((0.0, 0.0, 0.0), (0.01, 0.02, 0.0), (0.03, 0.0, 1e-3))
INVALID: tuple[Any, ...] = (None, "1", True, float("nan"), float("inf"), 10**400, [1.0])
FIGURES = ("c", "alpha", "beta", "pitch", "deviation")


def array(**fields: Any) -> Array:
    usual: dict[str, Any] = {"positions": PLACES, "c": 0.0, "alpha": 3.0, "beta": -0.1}
    return Array(**usual | fields)


def six(**fields: Any) -> SpatialArray:
    usual: dict[str, Any] = {"positions": SIX_PLACES, "alpha": 3.0, "beta": -0.1}
    return SpatialArray(**usual | fields)


@pytest.mark.parametrize("of", [list, np.array])
def test_places_may_be_lists_or_arrays(of: Any) -> None:
    from_sequences = array(positions=of([of(r) for r in PLACES]), alpha=np.float32(3))
    assert from_sequences == array() and hash(from_sequences) == hash(array())
    assert type(from_sequences.alpha) is type(from_sequences.positions[1][0]) is float
    assert six(positions=of([of(r) for r in SIX_PLACES])) == six()


@pytest.mark.parametrize("value", INVALID, ids=lambda v: repr(v)[:6])
@pytest.mark.parametrize("name", FIGURES)
def test_what_is_no_figure_of_an_array_is_refused(name: str, value: Any) -> None:
    with pytest.raises(ModelError, match=rf"{name} is .*must be finite"):
        array(**{name: value})
    with pytest.raises(ModelError, match="must be finite"):
        six(**{"height" if name == "c" else name: value})


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        (None, "positions are None: give . numbers"),
        ("ab", "has 1 numbers: give"),
        ((0.0, 1.0), "positions are .0.0, 1.0.: give . numbers"),
        (((0.0,), (1.0,)), "has 1 numbers"),
        (((0.0,) * 4, (1.0,) * 4), "has 4 numbers"),
        ((("a",) * 2, (1.0, 1.0)), "one of positions is 'a'|has 2 numbers: give 3"),
        ((("a",) * 3, (1.0,) * 3), "one of positions is 'a'|has 3 numbers: give 2"),
    ],
)
def test_what_is_no_place_is_refused(positions: Any, message: str) -> None:
    for make in (array, six):
        with pytest.raises(ModelError, match=message):
            make(positions=positions)


def test_more_sensors_than_are_named_are_refused() -> None:
    many = [(1e-3 * k, 0.0, 0.0) for k in range(27)]
    with pytest.raises(ModelError, match=r"27 positions: .* 26 at most"):
        six(positions=many)
    with pytest.raises(ModelError, match="27 positions"):
        array(positions=[r[:2] for r in many])
    assert len(channels.voltages(len(six(positions=many[:26]).positions))) == 52


def test_each_figure_of_a_tuning_is_a_number_or_refused() -> None:
    for name in Tuning.__dataclass_fields__:
        for value in INVALID:
            with pytest.raises(ModelError, match=f"^{name} is "):
                Tuning(**{name: value})


def test_what_is_counted_is_a_whole_number() -> None:
    for counted in ("iterations", "pitches"):
        for value in (2.5, 2.0, 0, 1001):
            with pytest.raises(ModelError, match=f"{counted} is {value}: give a whole number of at least 1"):
                Tuning(**{counted: value})  # type: ignore[arg-type]
        assert getattr(Tuning(**{counted: np.int64(2)}), counted) == 2  # type: ignore[arg-type]


@pytest.mark.parametrize("time", [None, Continuous(), 1 / 800])
def test_an_estimator_takes_a_period(time: Any) -> None:
    two = config.array()
    with pytest.raises(TimingError, match=r"`time` of `block.build` is .*: give a Discrete"):
        estimator.guarded_estimator(two, time)
    with pytest.raises(TimingError, match=r"`time` of `block.build` is .*: give a Discrete"):
        estimator.estimator(two, time)


@pytest.mark.parametrize("name", ["hall", "", None, ["hall_position_four"]])
def test_what_does_not_ship_is_refused(name: Any) -> None:
    with pytest.raises(DesignError, match="give one of hall_position_four, hall_position_three"):
        protected.array(name)
