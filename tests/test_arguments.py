"""Names in every form that can be listed, and what is no list of names."""

import importlib
import inspect
import pkgutil
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal, NewType, Protocol, TypeVar

import numpy as np
import pytest
import scipy.linalg
from numpy.typing import ArrayLike

import synth
from synth import arguments
from synth.errors import ModelError, SignalError, TimingError


@pytest.mark.parametrize("values", [["gap", "tilt"], ("gap", "tilt"), np.array(["gap", "tilt"]), {"gap": 1, "tilt": 2}])
def test_any_list_of_texts_is_read(values: object) -> None:
    names = arguments.as_name_list("outputs", values)
    assert names == ("gap", "tilt")
    assert all(type(name) is str for name in names)


def test_one_text_is_one_name_and_none_are_none() -> None:
    assert arguments.as_name_list("outputs", "gap") == ("gap",)
    assert arguments.as_name_list("outputs", []) == ()
    assert arguments.as_name_list("outputs", iter(["gap"])) == ("gap",)


@pytest.mark.parametrize("values", [None, 3, [3], [None], [["gap"]], np.array([["gap", "tilt"]])])
def test_what_is_no_list_of_names_is_refused(values: object) -> None:
    with pytest.raises(SignalError, match=r"the outputs are .*: give names of signals, in one list"):
        arguments.as_name_list("outputs", values)


@dataclass(frozen=True)
class Box:
    """A size and a name."""

    width: float
    name: str = ""


Kept = arguments.checked(Box)


@arguments.checked
def take(
    x_s: float = 1.0,
    count: int = 1,
    certain: bool = False,
    name: str = "",
    listed: Sequence[str] = (),
    mapped: Mapping[str, float] | None = None,
    matrix: ArrayLike | Mapping[str, float] | None = None,
    box: Box | None = None,
    pair: tuple[float, float] = (0.0, 1.0),
    law: Callable[[float], float] = abs,
    system: Any = None,
    *more: int,
    **others: float,
) -> str:
    """Take one of each kind."""
    return "taken"


GOOD: list[tuple[str, Any]] = [
    *(("x_s", value) for value in (1, -2.5, 0.0, np.float32(1e-3), np.int8(3), np.array(2.0), 1e100, np.nan, -np.inf)),
    *(("count", value) for value in (3, np.int64(3))),
    ("certain", np.True_),
    *(("listed", value) for value in (["a"], ("a", "b"), np.array(["a"]), [])),
    *(("mapped", value) for value in (None, {"a": 1})),
    *(("matrix", value) for value in (None, {"a": 1.0}, 3.0, [[1, 2]], np.eye(2), np.ma.array([1.0, 2.0]))),
    ("box", Box(1.0)),
    ("pair", [1, 2]),
    ("law", np.sqrt),
    *(("system", value) for value in ("anything", None)),
    ("other", 3.0),
]
BAD: list[tuple[str, Any, str]] = [
    ("x_s", None, r"`x_s` of `test_arguments.take` is None: give a number of seconds"),
    *(("x_s", value, "give a number") for value in ("1", True, 1j, [1.0], np.ones(1), 1e300)),
    *(("x_s", value, "give a number") for value in (-(10**400), np.ma.masked)),
    *(("count", value, "give a whole number") for value in (1.0, True, "1", None)),
    *(("certain", value, "give True or False") for value in (1, "yes", None)),
    ("name", 3, "`name` of .* is 3: give a text"),
    *(("listed", value, "give a list of names") for value in ("a", 3, None, [3], {"a": 1}, np.array("a"))),
    *(("mapped", value, "give a mapping from a text to a number") for value in ([1.0], {1: 1.0}, {"a": "b"})),
    *(("matrix", value, "an array of numbers without a mask") for value in ("1", True, {"a": None}, abs)),
    ("matrix", np.ma.array([[1.0, 2.0]], mask=[[True, False]]), r"a masked array of shape \(1, 2\)"),
    ("matrix", [np.ma.array([1.0, 2.0], mask=[True, False])], "without a mask"),
    *(("box", value, "give a Box or None") for value in (1.0, Box, {"width": 1.0})),
    *(("pair", value, "give 2 of them") for value in ((1.0,), 1.0, ("a", "b"))),
    ("law", 1.0, "give a function"),
    ("other", "3", "`other` of .* is '3': give a number"),
]


@pytest.mark.parametrize(("name", "value"), GOOD)
def test_what_an_annotation_says_passes(name: str, value: Any) -> None:
    assert take(**{name: value}) == "taken"


@pytest.mark.parametrize(("name", "value", "message"), BAD)
def test_what_it_does_not_say_is_refused_by_name(name: str, value: Any, message: str) -> None:
    with pytest.raises(TimingError if name == "x_s" else SignalError, match=message):
        take(**{name: value})


def test_arguments_by_place_are_checked_as_those_by_name() -> None:
    with pytest.raises(SignalError, match=r"`count` of .* is 'three'"):
        take(1.0, "three")  # type: ignore[arg-type]
    with pytest.raises(SignalError, match=r"`more` of .* is 0.5: give a whole number"):
        take(1.0, 1, False, "", (), None, None, None, (0, 1), abs, None, 1, 0.5)  # type: ignore[arg-type]


def test_a_constructor_is_checked_and_stays_what_it_was() -> None:
    assert Kept is Box and replace(Kept(1.0), width=2.0) == Box(2.0)
    with pytest.raises(SignalError, match="`width` of `Box` is 'wide': give a number"):
        Kept("wide")  # type: ignore[arg-type]
    with pytest.raises(SignalError, match="`name` of `Box` is 3: give a text"):
        replace(Kept(1.0), name=3)  # type: ignore[arg-type]


def test_a_checked_function_keeps_its_name_its_text_and_its_signature() -> None:
    assert take.__name__ == "take" and take.__doc__ == "Take one of each kind."
    assert list(inspect.signature(take).parameters)[:2] == ["x_s", "count"]


@pytest.mark.parametrize(
    "fail",
    [
        lambda x: np.linalg.solve(np.zeros((2, 2)), np.ones(2)),
        lambda x: 1e200**2.0,
        lambda x: 1 / 0,
        lambda x: scipy.linalg.schur(np.full((2, 2), np.nan)),
        lambda x: int(np.inf),
    ],
)
def test_arithmetic_beyond_double_precision_is_a_model_error(fail: Callable[[float], Any]) -> None:
    fail.__annotations__["x"] = float
    with pytest.raises(ModelError, match="cannot compute with these numbers in double precision"):
        arguments.checked(fail)(1.0)


@pytest.mark.parametrize("wrong", [TypeError, AttributeError, KeyError, ValueError])
def test_a_mistake_of_ours_stays_raw(wrong: type[Exception]) -> None:
    def fail() -> None:
        raise wrong("ours")

    with pytest.raises(wrong, match="ours"):
        arguments.checked(fail)()


@pytest.mark.parametrize("values", ["1", ["1"], [1j], [None], [[1], [1, 2]], [object()], [np.ma.masked], [1e101]])
def test_what_is_no_array_of_numbers_is_refused(values: Any) -> None:
    with pytest.raises(SignalError, match="the weights"):
        arguments.real("weights", values)


ARRAY = "an array of numbers without a mask"


@pytest.mark.parametrize(
    ("annotation", "need"),
    [
        (ArrayLike, ARRAY),
        (arguments.Array, ARRAY),
        (ArrayLike | None, f"{ARRAY} or None"),
        (arguments.Array | None, f"{ARRAY} or None"),
        (ArrayLike | float, ARRAY),
        (ArrayLike | Mapping[str, float], f"a mapping from a text to a number or {ARRAY}"),
        (ArrayLike | Sequence[str] | None, f"a list of names or a text or {ARRAY} or None"),
        (ArrayLike | Sequence[complex], f"a list, each entry a number or {ARRAY}"),
        (Sequence[ArrayLike], f"a list, each entry {ARRAY}"),
        (Mapping[str, ArrayLike], f"a mapping from a text to {ARRAY}"),
        (tuple[Box, ArrayLike], f"2 of them: a Box, {ARRAY}"),
    ],
)
def test_arrays_are_read_in_every_annotation_by_every_version_of_numpy(annotation: Any, need: str) -> None:
    kind = arguments.of(annotation)
    assert kind is not None and kind.need == need
    assert not any(map(kind.passes, (b"x", True, {1.0}, abs, np.ma.masked, {"a": "b"})))


class Sized(Protocol):
    """A class that only says what its instances can do."""

    size: int


UNREADABLE: list[Any] = [
    *(Literal["a"], Sized, TypeVar("T"), NewType("Length", float), set[int], Iterator[float], Counter[str]),
    *(Sized | None, Any | Sized, Sequence[Sized], Mapping[str, Literal[1]], tuple[float, Sized]),
]


@pytest.mark.parametrize("annotation", UNREADABLE)
def test_an_annotation_that_cannot_be_read_is_refused_at_the_first_call(annotation: Any) -> None:
    def planted(gap: object) -> object:
        return gap

    planted.__annotations__["gap"] = annotation
    with pytest.raises(TypeError, match=r"cannot read the annotation of `gap` of `test_arguments.*planted` .*: give"):
        arguments.checked(planted)(1.0)


def test_a_parameter_without_annotation_is_refused_at_the_first_call() -> None:
    with pytest.raises(TypeError, match=r"`gap` of `test_arguments.* has no annotation.*: give it one, or Any"):
        arguments.checked(lambda gap: gap)(1.0)


def checked_functions() -> Iterator[tuple[str, Callable[..., Any]]]:
    """Yield the functions, constructors and methods of the toolkit that check their arguments, and their names."""
    for info in pkgutil.walk_packages(synth.__path__, "synth."):
        module = importlib.import_module(info.name)
        of_module = [v for v in vars(module).values() if getattr(v, "__module__", "") == info.name]
        members = [m for v in of_module if inspect.isclass(v) for m in vars(v).values()]
        for function in [*of_module, *members]:
            if getattr(function, "__code__", None) is take.__code__:  # type: ignore[attr-defined]
                yield f"{info.name}.{function.__qualname__}", function.__wrapped__


def test_every_annotation_of_the_toolkit_is_read() -> None:
    named = list(checked_functions())
    assert len(named) > 200
    for name, function in named:
        arguments.kinds_of(function, name)
