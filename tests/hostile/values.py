"""Hostile values, with which `tests.hostile.search` replaces valid arguments."""

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import casadi as ca
import control
import numpy as np

from synth.statespace import StateSpace

SAME = "the same as "  # a mutation of that name changes the form of a value, not the value

NUMBERS: dict[str, Any] = {
    "0": 0,
    "-1": -1,
    "NaN": np.nan,
    "infinity": np.inf,
    "-infinity": -np.inf,
    "1e300": 1e300,
    "-1e300": -1e300,
    "1e-300": 1e-300,
    "a large whole number": 10**30,
    "2**40": 2**40,
    "float32": np.float32(0.1),
    "a NaN array": np.full((2, 2), np.nan),
    "a large array": np.full((2, 2), 1e300),
}
SOMETIMES_RIGHT: dict[str, Any] = {  # what some annotations ask for
    "None": None,
    "a text": "text",
    "an empty text": "",
    "a bool": True,
    "1.5": 1.5,
    "an empty list": [],
    "a list of a number": [1.0],
    "a list of texts": ["a", "b"],
    "an empty mapping": {},
    "a mapping": {"x": 1.0},
    "an empty array": np.zeros((0, 0)),
    "a row": np.ones((1, 3)),
    "three dimensions": np.ones((1, 1, 1)),
}
SELDOM_RIGHT: dict[str, Any] = {
    "a complex number": 1 + 2j,
    "bytes": b"x",
    "a list of None": [None],
    "nested lists": [[1.0, 2.0], [3.0]],
    "a set": {1.0},
    "an object": object(),
    "a complex array": np.full((2, 2), 1j),
    "an array of texts": np.array([["a"]]),
    "a function": lambda *a: None,
    "a masked array": np.ma.array(np.ones((2, 2)), mask=[[True, False], [False, True]]),
    "masked": np.ma.masked,
    "a symbol": ca.SX.sym("s"),
    "an array of objects": np.array([None, 1.0], dtype=object),
}
KINDS = SOMETIMES_RIGHT | SELDOM_RIGHT


def mutations(value: Any) -> Iterator[tuple[str, Any]]:
    """Yield replacements of a good value, each with its name."""
    yield from (NUMBERS | KINDS).items()
    if isinstance(value, np.ndarray) or _is_table(value):
        yield from _arrays(np.asarray(value))
    if isinstance(value, np.ndarray):
        yield SAME + "lists", value.tolist()
        yield SAME + "Fortran's order", np.asfortranarray(value)
        yield SAME + "a mask of nothing", np.ma.array(value)
    if isinstance(value, float | int) and not isinstance(value, bool):
        yield from {"negative": -value, "a hundred times": 100 * value, "a list of it": [value]}.items()
        yield SAME + "a NumPy scalar", np.float64(value) if isinstance(value, float) else np.int64(value)
    if isinstance(value, list | tuple):
        yield from _lists(value)
    if isinstance(value, Mapping):
        yield from _mappings(value)
    if isinstance(value, StateSpace):
        yield from _models(value)


def _is_table(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(row, list | float) for row in value)


def _arrays(value: Any) -> Iterator[tuple[str, Any]]:
    array = value.astype(float) if value.dtype.kind in "if" else value
    yield from {"transposed": array.T, "flat": array.ravel(), "one more dimension": array[None]}.items()
    yield from {"one row less": array[:-1], "doubled": np.concatenate([array, array]), "negative": -array}.items()
    yield from {
        "zero": 0 * array,
        "single precision": array.astype(np.complex64 if array.dtype.kind == "c" else np.float32),
    }.items()
    yield from {"huge": 1e300 * array, "tiny": 1e-300 * array, "large": 1e90 * array, "small": 1e-90 * array}.items()
    for name, number in (("NaN", np.nan), ("infinity", np.inf), ("1e300", 1e300), ("1e200", 1e200), ("1j", 1j)):
        changed = array.astype(complex) if name == "1j" else array.copy()
        if changed.size:
            changed.flat[0] = number
        yield f"{name} first", changed
    mask = np.zeros(array.shape, dtype=bool)
    mask.flat[:1] = True
    yield "the first masked", np.ma.array(array, mask=mask)
    yield "text", array.astype(str)


def _lists(value: Sequence[Any]) -> Iterator[tuple[str, Any]]:
    items = list(value)
    for name, entry in (("None", None), ("a text", "text"), ("NaN", np.nan), ("1e300", 1e300), ("a bool", True)):
        yield f"{name} added", [*items, entry]
        yield f"{name} first", [entry, *items[1:]]
    yield from {"its first entry": items[0] if items else 0.0, "doubled": items * 2, "nested": [items]}.items()
    yield from {"without the last": items[:-1], "as keys": {str(k): v for k, v in enumerate(items)}}.items()
    yield SAME + "a tuple", tuple(items)


def _mappings(value: Mapping[Any, Any]) -> Iterator[tuple[str, Any]]:
    yield "a wrong name", {**value, "wrong": next(iter(value.values()), 1.0)}
    yield "a number for a name", {**value, 3: 1.0}
    yield "its names", list(value)
    yield "its values", list(value.values())
    for name, entry in (("None", None), ("text", "text"), ("NaN", np.nan), ("infinity", np.inf), ("1e300", 1e300)):
        yield f"{name} inside", dict.fromkeys(value, entry)
    yield "a list inside", {key: [1.0] for key in value}


def _models(value: StateSpace) -> Iterator[tuple[str, Any]]:
    A, B, C, D = value.A, value.B, value.C, value.D
    n, m, p = len(A), B.shape[1], len(C)
    yield "arrays with NaN", (A * np.nan, B, C, D, value.time)
    yield "arrays with 1e300", (A, 1e300 * B, C, D, value.time)
    for size in (1e-300, 1e-90, 1e90):
        yield f"A {size:g}", dataclasses.replace(value, A=A * size)
        yield f"B {size:g}", dataclasses.replace(value, B=B * size)
        yield f"C {size:g}", dataclasses.replace(value, C=C * size)
    yield "a masked A", (np.ma.array(A, mask=np.eye(n, dtype=bool)), B, C, D, value.time)
    yield "a complex A", (A * 1j, B, C, D, value.time)
    yield "A of zeros", dataclasses.replace(value, A=0 * A)
    yield "B of zeros", dataclasses.replace(value, B=0 * B)
    yield "C of zeros", dataclasses.replace(value, C=0 * C)
    yield "A as text", ("text", B, C, D)
    yield SAME + "arrays", (A, B, C, D, value.time)
    yield SAME + "python-control", value.to_control()
    yield "shapes that do not fit", (A, B[:-1], C, D)
    yield "A alone", (A,)
    yield "no states", dataclasses.replace(value, A=np.zeros((0, 0)), B=np.zeros((0, m)), C=np.zeros((p, 0)), states=())
    yield "no inputs", dataclasses.replace(value, B=np.zeros((n, 0)), D=np.zeros((p, 0)), inputs=())
    yield "no outputs", dataclasses.replace(value, C=np.zeros((0, n)), D=np.zeros((0, m)), outputs=())
    yield "python-control, dt None", _control(value, None)
    yield "python-control, dt True", _control(value, True)
    yield "a static gain of python-control", _gain()
    yield "unstable", dataclasses.replace(value, A=-A)


def _control(model: StateSpace, dt: Any) -> Any:
    return control.StateSpace(model.A, model.B, model.C, model.D, dt)


def _gain() -> Any:
    return control.ss([], [], [], [[2.0]])
