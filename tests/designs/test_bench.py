"""Laws of the shipped stages on a bench: proofs over the box, bits and instructions at the default, bits elsewhere.

maglev_5dof            weight of the rate of x, pole of its filter, anti-windup
maglev_5dof_precise    bandwidth and damping of x and z
planar_6dof_leadlag    gain of x
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache
from typing import Any
from unittest import mock

import numpy as np
import pytest

from designs.maglev_5dof import control as maglev
from designs.maglev_5dof.design import DESIGN as MAGLEV
from designs.maglev_5dof_precise.design import DESIGN as PRECISE
from designs.planar_6dof_leadlag import control as planar
from designs.planar_6dof_leadlag.design import DESIGN as PLANAR
from synth.blocks.laws import derivative_filter
from synth.declare.stage import Controller, Stage
from synth.declare.tuning import Bench, FreeParameter, Tuning
from synth.emit import write
from synth.emit.write import EmittedCode
from synth.execute import host
from synth.execute.target import load
from synth.stage import tunable
from synth.verify.proofs import eva, fuzz, prove
from tests import tools
from tests.designs.test_every_design import committed

MORE = 1.03  # instructions of a step with constants that change, over those of the step without
ROUNDING = 1e-6  # A, of 7 A: the product of a gain and a filter's factor is rounded once where neither changes
SAMPLES = 200


def on_maglev(p: Mapping[str, float]) -> Controller:
    axes = tuple(
        replace(a, weights=(*a.weights[:3], p["weight"], *a.weights[4:])) if a.name == "x" else a for a in maglev.AXES
    )
    block = derivative_filter.block

    def filter_block(name: str, *arguments: Any) -> Any:
        return block(name, *arguments[:-1], p["pole"] if name == "filter_x" else arguments[-1])

    decay = (p["decay"],) * 3
    with (
        mock.patch.multiple(maglev, AXES=axes, ANTI_WINDUP=decay),
        mock.patch.object(derivative_filter, "block", filter_block),
    ):
        controller = maglev.with_fault_handling(MAGLEV.plant)
        assert controller.block.states  # composed here
    return controller


def on_planar(p: Mapping[str, float]) -> Controller:
    with mock.patch.dict(planar.GAIN_SHARE, x=p["gain"]):
        block = planar.controller(PLANAR.plant)
    return replace(PLANAR.controller, compose=lambda: replace(PLANAR.controller.composition, block=block))


def stage(name: str) -> Stage:
    if name == "precise":
        assert PRECISE.tuning is not None
        ranges = {f.name: (0.9 * f.value, 1.1 * f.value) for f in PRECISE.tuning.free}
        return replace(PRECISE, tuning=replace(PRECISE.tuning, bench=Bench(ranges)))
    weight = next(a.weights[3] for a in maglev.AXES if a.name == "x")
    free = {
        "maglev": [
            FreeParameter("weight", weight, weight / 2, weight * 2),
            FreeParameter("pole", maglev.FILTER, 800.0, 1200.0, "rad/s"),
            FreeParameter("decay", maglev.ANTI_WINDUP[0], 5e-5, 9e-5),
        ],
        "planar": [FreeParameter("gain", planar.GAIN_SHARE["x"], 0.3, 0.5)],
    }[name]
    bench = Bench({f.name: (f.low, f.high) for f in free})
    whole, law = (MAGLEV, on_maglev) if name == "maglev" else (PLANAR, on_planar)
    return replace(whole, tuning=Tuning(free, law, bench=bench))


NAMES = ("planar", "precise", "maglev")
pytestmark = pytest.mark.whole


@cache
def emitted(name: str, with_bench: bool) -> EmittedCode:
    of = stage(name)
    block = tunable.with_bench(of) if with_bench else of.controller.block
    return write.emit(block, of.scalar, error=of.surrogate_error.get(of.scalar))


def recorded(code: EmittedCode) -> dict[str, np.ndarray]:
    return {n: np.array(u) for n, u in committed(code.manifest["design"])[2]["inputs"].items()}


def replayed(code: EmittedCode, state: host.Records | None = None) -> dict[str, np.ndarray]:
    return host.load(code.files, code.manifest).replay(recorded(code), state).outputs


def gap(first: Mapping[str, np.ndarray], second: Mapping[str, np.ndarray]) -> float:
    return max(float(np.max(np.abs(first[n] - second[n]))) for n in first)


@pytest.mark.parametrize("name", NAMES)
def test_untuned_the_outputs_and_the_cost_are_those_without_a_bench(name: str) -> None:
    tuned, plain = emitted(name, True), emitted(name, False)
    assert gap(replayed(tuned), replayed(plain)) <= (ROUNDING if name == "maglev" else 0.0)
    inputs = {n: u[:SAMPLES] for n, u in recorded(plain).items()}
    costs = [load(code.files, code.manifest).measure(inputs).cost.instructions for code in (tuned, plain)]
    assert costs[0].max() <= MORE * costs[1].max() and costs[0].mean() <= MORE * costs[1].mean()


@pytest.mark.parametrize("name", NAMES)
def test_tuned_the_outputs_are_those_of_the_law_with_these_parameters(name: str) -> None:
    of, code = stage(name), emitted(name, True)
    assert of.tuning is not None and of.tuning.bench is not None
    at = {f.name: f.value for f in of.tuning.free}
    at |= {n: low + 0.8 * (high - low) for n, (low, high) in of.tuning.bench.ranges.items()}
    constants = tunable.constants_at(of.tuning, at)
    controller = host.load(code.files, code.manifest)
    state = controller.init()
    assert controller.tune(state, {n: constants[n] for n in code.manifest["tuning"]["default"]}) == 0
    other = write.emit(of.tuning.controller(at).block, of.scalar, error=of.surrogate_error.get(of.scalar))
    assert gap(replayed(code, state), replayed(other)) <= (ROUNDING if name == "maglev" else 0.0)
    assert gap(replayed(code), replayed(other)) > ROUNDING


@tools.needs(*tools.PROVERS, shows="that what is proved of the step holds over the bench")
@pytest.mark.parametrize("name", NAMES)
def test_the_proofs_hold_over_the_whole_box(name: str) -> None:
    code = emitted(name, True)
    files = host.code(code.files)
    checks = [*fuzz.run(files, code.manifest, prove.SUBSET_STEPS).checks(), *prove.inspect(files).checks()]
    checks += eva.prove(files, code.manifest).checks()
    assert [c.about for c in checks if not c.passed] == []


@tools.needs(*tools.PROVERS, shows="that what is proved of the step holds over the bench")
def test_a_check_of_the_range_that_is_missing_is_found() -> None:
    """The planted defect of the proofs: constants that are taken wherever they are."""
    code = emitted("planar", True)
    files = host.code(code.files)
    name = code.manifest["design"]
    holes = {n: text.replace("    if (!within) {", "    if (!within && (left == 0u)) {") for n, text in files.items()}
    assert holes[f"{name}.c"] != files[f"{name}.c"]
    assert not all(c.passed for c in fuzz.run(holes, code.manifest, prove.SUBSET_STEPS).checks())
