"""Frozen Hall channels in the shipped C: start-up beside the watch, what is named, and the time that it takes."""

import numpy as np
import pytest

from designs.planar_6dof import interface
from designs.planar_6dof.loop import compile_block
from designs.planar_6dof.sensing import sections as sensing
from designs.planar_6dof_leadlag.design import subject as leadlag
from designs.planar_6dof_lqg.design import subject as lqg
from models.planar_stage import HALL
from synth.blocks.faults import innovation_monitor
from synth.execute import host
from synth.fault import LATCH_BIT
from synth.statespace import Array
from tests.designs.planar_6dof import ideal_runs

ONSET, N = 300, 400
CODES = 15.0  # rms of the noise: 13 um
SEEN = {len(interface.SENSORS) + len(interface.INTERFACE.set_points) + k: name for k, name in enumerate(HALL)}


@pytest.fixture(scope="module", params=["leadlag", "lqg"])
def controller(request: pytest.FixtureRequest) -> host.Controller:
    return compile_block({"leadlag": leadlag, "lqg": lqg}[request.param]().block)


def at_rest(seed: int = 0, codes: float = CODES) -> dict[str, Array]:
    """Return inputs (N,) of a platen at rest, with noise of so many codes."""
    rng, inputs = np.random.default_rng(seed), {g.signal.name: np.zeros(N) for g in interface.INPUTS}
    inputs |= {name: np.full(N, v) for name, v in ideal_runs.at_rest().items()}
    for name in HALL:
        inputs[name] = interface.ADC * np.round(inputs[name] / interface.ADC + rng.normal(0, codes, N))
    return inputs


def suspects(word: int) -> list[str]:
    """Return the Hall voltages that a fault word suspects, and ``amplitude`` for its bit."""
    amplitude = ["amplitude"] if word >> sensing.AMPLITUDE_BIT & 1 else []
    return [name for bit, name in SEEN.items() if word >> bit & 1] + amplitude


@pytest.mark.parametrize("name", HALL)
def test_a_frozen_channel_is_the_only_suspect_in_the_promised_time(controller: host.Controller, name: str) -> None:
    for seed in range(8):
        inputs = at_rest(seed)
        inputs[name][ONSET + seed :] = inputs[name][ONSET + seed]
        faults = controller.replay(inputs).faults
        first = int(np.argmax(faults > 0))
        assert suspects(int(faults[first])) == [name] and faults[-1] >> LATCH_BIT
        repeats = 4  # by chance, of sound channels in the meantime
        known = innovation_monitor.longest(len(HALL), sensing.REPEATS)
        assert sensing.REPEATS <= first - ONSET - seed <= known + repeats


def test_an_earlier_contradiction_that_was_forgotten_adds_nothing(controller: host.Controller) -> None:
    inputs = at_rest()
    for name in HALL:
        inputs[name][100] *= 0.85
    inputs["V_bx"][ONSET:] = inputs["V_bx"][ONSET]
    faults = controller.replay(inputs).faults
    assert not faults[:ONSET].any() and suspects(int(faults[np.argmax(faults > 0)])) == ["V_bx"]


def test_sensors_that_start_late_set_the_scale_all_the_same(controller: host.Controller) -> None:
    """Voltages of 0 beside a bad distance: the first sound sample after them sets the scale, and nothing latches."""
    for late in range(1, interface.BAD_SAMPLES):
        inputs = at_rest()
        for name in HALL:
            inputs[name][:late] = 0.0
        inputs["d1"][:late] = np.nan
        faults = controller.replay(inputs).faults
        assert faults[:late].all() and not faults[late:].any()


def test_several_frozen_channels_are_seen_by_one(controller: host.Controller) -> None:
    inputs = at_rest()
    for name in HALL:
        inputs[name][ONSET:] = inputs[name][ONSET]
    faults = controller.replay(inputs).faults
    assert len(suspects(int(faults[np.argmax(faults > 0)]))) == 1 and faults[-1] >> LATCH_BIT


def test_noise_of_some_codes_is_no_failure(controller: host.Controller) -> None:
    assert not any(controller.replay(at_rest(seed, codes=4.0)).faults.any() for seed in range(20))
