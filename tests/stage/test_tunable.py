"""Constants that are tuned on the machine: bits at the default, at other values and on the way, and what is refused."""

import ctypes
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from designs.levitator_2dof import design as levitator
from synth import stage as stages
from synth.app import standard_tasks
from synth.block import Block, Constant, Exprs, Step, build
from synth.declare.stage import Stage
from synth.declare.tuning import Bench, FreeParameter, Tuning
from synth.emit import write
from synth.errors import EmitError
from synth.execute import host
from synth.execute.host import Controller
from synth.simulate import rig as rigs
from synth.stage import tunable

DESIGN = levitator.DESIGN
TUNED = {f.name: f.value for f in levitator.FREE} | {"damping_z": 1500.0}


def without_bench(stage: Stage) -> Stage:
    assert stage.tuning is not None
    return replace(stage, tuning=replace(stage.tuning, bench=None))


@cache
def tuned() -> Controller:
    return host.compile_block(tunable.with_bench(DESIGN))


def values(of: Mapping[str, float]) -> dict[str, float]:
    assert DESIGN.tuning is not None
    constants = tunable.constants_at(DESIGN.tuning, of)
    return {n: constants[n] for n in tuned().manifest["tuning"]["default"]}


@cache
def inputs() -> Mapping[str, np.ndarray]:
    return standard_tasks.record(rigs.of_stage(DESIGN, tuned()))


def bits(controller: Controller, state: host.Records | None = None) -> list[bytes]:
    outputs = controller.replay(inputs(), state).outputs
    return [outputs[name].tobytes() for name in sorted(outputs)]


def test_untuned_the_outputs_have_the_bits_of_the_law_without_a_bench() -> None:
    assert bits(tuned()) == bits(host.compile_block(without_bench(DESIGN).controller.block))


def test_tuned_the_outputs_have_the_bits_of_the_law_with_these_parameters() -> None:
    state = tuned().init()
    assert tuned().tune(state, values(TUNED)) == 0
    other = host.compile_block(levitator.controller(TUNED).block)
    assert bits(tuned(), state) == bits(other) != bits(tuned())


def test_on_the_way_each_constant_lies_between_its_ends_and_arrives() -> None:
    state, target = tuned().init(), values(TUNED)
    start = {n: float(state[n]) for n in target}
    calls = tuned().manifest["tuning"]["calls"]
    assert calls == 200  # 0.1 s at 2 kHz
    last = dict(start)
    for left in range(calls, 0, -1):
        assert tuned().tune(state, target, left) == 0
        for n, value in target.items():
            end = np.float32(value)
            ahead = np.sign(end - start[n])
            assert (float(state[n]) - last[n]) * ahead >= 0 and (end - float(state[n])) * ahead >= 0, n
            last[n] = float(state[n])
    assert last == {n: float(np.float32(value)) for n, value in target.items()}


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf, "below", "above"])
@pytest.mark.parametrize("name", ["servo_z_w_z_command_from_sum", "servo_z_start_sum_from_z_held"])
def test_a_value_that_is_not_in_its_range_changes_nothing(name: str, bad: float | str) -> None:
    fields = {f["name"]: f for f in tuned().manifest["structs"]["parameters"]["fields"]}
    ends = {"below": fields[name]["low"], "above": fields[name]["high"]}
    outside = {"below": -np.inf, "above": np.inf}
    value = np.nextafter(np.float32(ends[bad]), np.float32(outside[bad])) if isinstance(bad, str) else bad
    state = tuned().init()
    assert tuned().tune(state, values(TUNED) | {name: float(value)}) == 2
    assert state.tobytes() == tuned().init().tobytes()
    if isinstance(bad, str):
        assert tuned().tune(state, values(TUNED) | {name: ends[bad]}) == 0


def test_each_end_of_a_range_is_taken_as_the_header_prints_it() -> None:
    emitted = write.emit(tunable.with_bench(DESIGN), np.float32)
    struct = re.search(r"typedef struct \{([^}]*)\} levitator_2dof_parameters_t;", emitted.files["levitator_2dof.h"])
    assert struct is not None
    ends = re.findall(r", (\S+) \.\. ([^\s:]+): servo of z", struct[1])
    assert len(ends) == len(values(TUNED))
    for name, printed in zip(values(TUNED), ends, strict=True):
        for end in printed:
            assert tuned().tune(tuned().init(), values(TUNED) | {name: float(end)}) == 0, (name, end)


def test_half_of_a_change_changes_nothing() -> None:
    """Every split of a write, from either end, is refused, whether the check is written or not."""
    old, new = tuned().parameters(values(TUNED)), tuned().parameters(tuned().manifest["tuning"]["default"])
    names = list(old.dtype.names or ())
    refused = 0
    for k in range(1, len(names)):
        for first, second in ((old, new), (new, old)):
            torn = second.copy()
            for n in names[:k]:
                torn[n] = first[n]
            if torn.tobytes() in (old.tobytes(), new.tobytes()):
                continue
            state = tuned().init()
            assert call(state, torn) == 1 and state.tobytes() == tuned().init().tobytes()
            refused += 1
    assert refused == 2 * (len(names) - 1)


def call(state: host.Records, parameters: host.Records, left: int = 1) -> int:
    move = ctypes.CFUNCTYPE(ctypes.c_uint32, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_uint32)
    tune = move((tuned().manifest["tuning"]["functions"]["tune"], tuned().library))
    return int(tune(state.ctypes.data, parameters.ctypes.data, left))


def test_no_call_left_changes_nothing() -> None:
    state = tuned().init()
    assert tuned().tune(state, values(TUNED), 0) == 4 and state.tobytes() == tuned().init().tobytes()


def dividing(gain: float) -> Block:
    """Return a law that divides by a gain."""

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"i1_demand": u["z_error"] / k["gain"], "i2_demand": u["x_error"]})

    interface = levitator.INTERFACE
    return build(
        "law",
        levitator.TIME,
        law,
        inputs=[interface.error("z"), interface.error("x")],
        outputs=[interface.demand("i1"), interface.demand("i2")],
        constants=[Constant("gain", gain, "m/A", "of the test")],
    )


def test_a_range_that_is_not_proved_is_refused_with_the_largest_that_is() -> None:
    def controller(p: Mapping[str, float]) -> stages.Controller:
        return stages.controller("levitator_2dof", levitator.TIME, levitator.INTERFACE, [dividing(p["gain"])])

    tuning = Tuning([FreeParameter("gain", 1.0, -2.0, 4.0, "m/A")], controller, bench=Bench({"gain": (-1.0, 3.0)}))
    stage = replace(DESIGN, controller=controller({"gain": 1.0}), tuning=tuning)
    with pytest.raises(EmitError) as refused:
        standard_tasks.emit(stage, np.float32)
    text = str(refused.value)
    assert "the denominator" in text and "law_gain" in text
    ends = re.search(r"declare gain within (\S+) \.\. (\S+), over which it is proved", text)
    assert ends is not None
    low, high = map(float, ends.groups())
    # The range is widened by 5 % at each end, and no longer holds 0 from 10/11 of the way to it on.
    assert 0.09 < low < 0.21 and high == pytest.approx(1 + 2 * (1 - low) / 2, rel=1e-3)
    narrowed = replace(tuning, bench=Bench({"gain": (low, high)}))
    assert tunable.with_bench(replace(stage, tuning=narrowed)).tunable == ("law_gain",)
