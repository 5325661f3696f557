"""Intermediate values of a law get the names of the Python variables that hold them."""

import cProfile
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import casadi as ca
import numpy as np
import pytest

from synth import intermediates
from synth.block import Exprs, Step, build
from synth.composition import compose
from synth.emit import pipeline
from synth.signals import Signal
from synth.timing import Discrete

T = Discrete(1e-3)
X, Y = Signal("x", "m", -1.0, 1.0), Signal("y", "m", -4.0, 4.0)
x = ca.SX.sym("x")


@dataclass(frozen=True, eq=False)
class Wave:
    sine: ca.SX
    cosine: ca.SX


class Limits(NamedTuple):
    low: ca.SX
    high: ca.SX


def values_by_name(law: object) -> dict[str, str]:
    _, values = intermediates.record(law)  # type: ignore[arg-type]
    return {name: str(expr) for name, expr in values}


def test_a_variable_names_its_value_and_a_caller_renames_it() -> None:
    def root(u: ca.SX) -> ca.SX:
        inner = u + 1
        doubled = 2 * inner
        return doubled if inner.n_dep() else inner

    def law() -> ca.SX:
        twice = root(x)
        return twice**2

    assert values_by_name(law) == {"inner": "(x+1)", "twice": "(2.*(x+1))"}


def test_containers_name_their_elements() -> None:
    def law() -> None:
        force = {"x": x + 1, "z": x + 2}
        wave, bounds, pair = Wave(x + 3, x + 4), Limits(x + 5, x + 6), (x + 7, x)
        J = ca.vertcat(x + 8, x + 9)
        R = ca.blockcat([[x + 10, x + 11], [x + 12, 0]])
        assert len(force) + len(pair) + J.numel() + R.numel() + len(bounds) and wave

    expected = {"force_x", "force_z", "wave_sine", "wave_cosine", "bounds_low", "bounds_high", "pair_1"}
    assert values_by_name(law).keys() == expected | {"J_1", "J_2", "R_11", "R_21", "R_12"}


def test_a_loop_names_the_value_of_each_iteration_after_what_it_runs_over() -> None:
    """A variable that exists before the loop keeps its name for its last value."""

    def law() -> ca.SX:
        total = x + 1
        for n in ("x", "z"):
            error = x * {"x": 2, "z": 3}[n]
            total = total + error
        for signal in (X, Y):
            pushed = x + signal.high + 7
        return total + pushed

    assert values_by_name(law).keys() == {"error_x", "error_z", "total_x", "total", "pushed_x", "pushed_y"}
    assert values_by_name(law)["error_z"] == "(3*x)"


def test_a_loop_in_a_loop_names_the_values_after_both() -> None:
    def law() -> ca.SX:
        total = x + 1
        for sensor in "ab":
            for axis in ("x", "y"):
                volts = (ord(axis) + 100 * ord(sensor)) * x
                total += volts
        return total

    names = {f"{variable}_{sensor}_{axis}" for variable in ("volts", "total") for sensor in "ab" for axis in "xy"}
    assert values_by_name(law).keys() == names - {"total_b_y"} | {"total"}  # the last sum has its variable's name


def test_the_values_of_a_called_function_are_named_after_what_its_caller_runs_over() -> None:
    """The caller may be a comprehension; one in the arguments of the call is not running, and its variable is stale."""

    def place(gain: int, among: Sequence[int] = ()) -> ca.SX:
        ratio = gain * x
        return ratio + len(among)

    def law() -> ca.SX:
        for axis in ("x", "y"):
            place(ord(axis))
        sums = [place(1000 * ord(n), [0]) for n in "ab"]
        place(7, [ord(axis) for axis in "xy"])
        return sums[0]

    ratios = {"ratio_x": "(120*x)", "ratio_y": "(121*x)", "ratio_a": "(97000*x)", "ratio_b": "(98000*x)"}
    values = values_by_name(law)
    assert {n: v for n, v in values.items() if n.startswith("ratio")} == {**ratios, "ratio": "(7*x)"}


def test_a_comprehension_hides_the_variable_of_a_loop_that_a_closure_holds() -> None:
    """Reading the frame ends Python 3.13.0 to 3.13.2 here (python/cpython#128396)."""

    def place(gain: int) -> ca.SX:
        ratio = gain * x
        return ratio + 1

    def law() -> ca.SX:
        total = x + 2
        for n in "ab":
            gap = sum((k * x + ord(n) for k in (3, 4)), start=x)
            total += gap + ca.vertcat(*[place(ord(n)) for n in "xy"])[0]
        return total

    assert values_by_name(law).keys() == {"ratio_x", "ratio_y", "gap_a", "gap_b", "total_a", "total"}


def test_a_loop_over_numbers_names_the_last_value() -> None:
    def law() -> ca.SX:
        for n in range(2):
            error = x * (n + 2)
        return error

    assert values_by_name(law) == {"error": "(3*x)"}


def test_a_key_that_begins_with_the_name_of_its_variable_is_the_name() -> None:
    def law() -> None:
        still = {"still_x": x + 1, "z": x + 2}
        assert len(still) == 2

    assert values_by_name(law).keys() == {"still_x", "still_z"}


def test_symbols_numbers_and_roles_have_no_name() -> None:
    def law() -> None:
        symbol, number, output, value = x, ca.SX(2.0), x + 1, x + 2
        assert symbol is x and number.is_constant() and output is not value

    assert values_by_name(law) == {}


def test_an_error_leaves_the_profiler_as_it_was() -> None:
    def law() -> None:
        raise ValueError("wrong")

    def profiler(*_: object) -> None:
        return None

    before, tracer = sys.getprofile(), sys.gettrace()
    try:
        sys.setprofile(profiler)
        with pytest.raises(ValueError, match="wrong"):
            intermediates.record(law)
        assert sys.getprofile() is profiler and sys.gettrace() is tracer
    finally:
        sys.setprofile(before)


def test_a_law_is_recorded_under_cprofile_which_goes_on() -> None:
    def profiled() -> None:
        intermediates.record(lambda: None)
        sorted([2, 1])

    profile = cProfile.Profile()
    profile.runcall(profiled)
    assert any("sorted" in str(entry.code) for entry in profile.getstats())


def test_values_with_symbols_of_another_block_are_left_out() -> None:
    other = ca.SX.sym("other")

    def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
        foreign, square = other + 1, u["x"] ** 2
        assert foreign.n_dep()
        return Step({"y": square + u["x"]})

    block = build("square", T, law, inputs=[X], outputs=[Y])
    assert [name for name, _ in block.intermediates] == ["square"]


def _quartic(name: str, source: Signal, target: Signal) -> object:
    def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
        square = u[source.name] ** 2
        unused = square + 3
        assert unused.n_dep()
        return Step({target.name: square + square**2})

    return build(name, T, law, inputs=[source], outputs=[target])


def test_a_composition_keeps_the_names_and_emission_drops_those_of_values_that_nothing_needs() -> None:
    z = Signal("z", "m", -25.0, 25.0)
    loop = compose("loop", [_quartic("first", X, Y), _quartic("second", Y, z)], inputs=["x"], outputs=["z"])  # type: ignore[list-item]
    assert [name for name, _ in loop.intermediates] == ["square", "unused"] * 2
    program = pipeline.reduce(loop, np.float32).program
    assert sorted(program.labels.values()) == ["square", "square"]


def test_a_value_whose_negative_is_computed_is_named_by_it() -> None:
    def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
        x = u["x"]
        slope = -(ca.sin(x) + x**3)
        return Step({"y": slope * x + slope**2})

    loop = compose("loop", [build("first", T, law, inputs=[X], outputs=[Y])], inputs=["x"], outputs=["y"])
    program = pipeline.reduce(loop, np.float32).program
    assert [*program.labels.values()] == ["minus_slope"]
    (k,) = program.labels
    assert program.nodes[k].op == "add"


def test_the_terms_of_a_sum_keep_the_names_that_they_have() -> None:
    def total(values: list[ca.SX]) -> ca.SX:
        terms = list(values)
        return terms[0] + terms[1]

    def law(u: Exprs, state: Exprs, k: Exprs) -> Step:
        square, cube = u["x"] ** 2, u["x"] ** 3
        return Step({"y": total([square, cube])})

    block = build("first", T, law, inputs=[X], outputs=[Y])
    assert [name for name, _ in block.intermediates] == ["square", "cube"]
