"""The simulated loop must be the loop of the equations: against matrix recursions, SciPy's integrator and mechanics."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from synth.errors import SignalError, WiringError
from synth.execute.host import Controller
from synth.plant import Plant
from synth.simulate import closed_loop
from synth.simulate.closed_loop import Scenario, Trajectory
from synth.simulate.scenario import Analogue, Encoder, Override

T, KP, KD, BIAS = 1e-3, 400.0, 6.0, 2.0
Level = Callable[[str], Controller]
BASE = Scenario(
    duration_s=0.3,
    x0={"q": 0.021, "v": 0.01},
    sensors={"gap": "gap"},
    actuators={"i": "current"},
    references={"gap_ref": 0.02},
    forcing={"j": 0.0},
    velocities={"q": "v", "s": "w"},
)


def recursion(n: int, delay: int, hold: float, start: tuple[float, float] = (0.021, 0.01)) -> np.ndarray:
    """The free mass of 2 kg under the regulator, exactly discretised, by hand: rows (q, v, command)."""
    A, B = np.array([[1, T], [0, 1]]), np.array([T**2 / 2, T]) / -2.0
    x, last, waiting, rows = np.array(start), 0.02, [hold] * delay, []
    for _ in range(n):
        waiting.append(BIAS + KP * (x[0] - 0.02) + KD * (x[0] - last) / T)
        rows.append([*x, waiting[-1]])
        last, x = x[0], A @ x + B * waiting.pop(0)
    return np.array(rows)


def gap_error(trajectory: Trajectory, expected: np.ndarray) -> float:
    columns = np.column_stack([trajectory["q"], trajectory["v"], trajectory["current"]])
    return float(np.max(np.abs(columns - expected) / np.abs(expected).max(axis=0)))


@pytest.mark.parametrize("delay", [0, 1, 2, 3])
def test_linear_loop_is_the_matrix_recursion(mass: Plant, level: Level, delay: int) -> None:
    trajectory = closed_loop.simulate(mass, level("float64"), replace(BASE, delay=delay, hold={"current": 1.5}))
    assert gap_error(trajectory, recursion(300, delay, 1.5)) < 1e-11
    assert gap_error(trajectory, recursion(300, delay + 1, 1.5)) > 1e-3
    if delay:
        assert gap_error(trajectory, recursion(300, delay, 0.0)) > 1e-5


def test_single_precision_controller_is_near_the_double(mass: Plant, level: Level) -> None:
    trajectory = closed_loop.simulate(mass, level("float32"), replace(BASE, hold={"current": 1.5}))
    assert trajectory["current"].dtype == np.float32
    assert 1e-9 < gap_error(trajectory, recursion(300, 1, 1.5)) < 1e-3


def fine_reference(n: int) -> np.ndarray:
    """The magnet under the regulator with one sample of delay, by SciPy at 1e-12: rows (q, v)."""
    x, last, command, rows = np.array([0.021, 0.01]), 0.02, 2.0, []
    for _ in range(n):
        rows.append(x)
        applied, command = command, BIAS + 400.0 * (x[0] - 0.02) + 6.0 * (x[0] - last) / T
        last = x[0]
        slope = lambda t, z, i=applied: [z[1], 9.81 - 0.002 / 2.0 * (i / z[0]) ** 2]  # noqa: E731
        x = solve_ivp(slope, (0, T), x, method="DOP853", rtol=1e-12, atol=1e-14).y[:, -1]
    return np.array(rows)


def test_nonlinear_loop_and_its_substeps(magnet: Plant, level: Level) -> None:
    scenario, exact = replace(BASE, hold={"current": 2.0}, duration_s=0.2), fine_reference(200)

    def error(substeps: int) -> float:
        trajectory = closed_loop.simulate(magnet, level("float64"), replace(scenario, substeps=substeps))
        return float(np.max(np.abs(trajectory["q"] - exact[:, 0])))

    assert error(40) < 1e-13
    assert error(4) < 1e-11
    assert 8 < error(1) / error(2) < 32, "fourth order: half the step leaves a sixteenth of the error"


@pytest.mark.parametrize("scalar", ["float32", "float64"])
def test_encoders_quantise_what_the_controller_reads(magnet: Plant, level: Level, scalar: str) -> None:
    encoder, controller = Encoder(1e-5), level(scalar)
    trajectory = closed_loop.simulate(magnet, controller, replace(BASE, encoders={"gap": encoder}))
    assert np.array_equal(trajectory.measured["gap"], encoder.read(trajectory.outputs["gap"]).astype(controller.scalar))
    assert np.max(np.abs(trajectory.measured["gap"] - trajectory["q"])) <= 0.5e-5 + 1e-9
    assert not np.array_equal(trajectory.measured["gap"], trajectory["q"].astype(controller.scalar))


def test_noise_is_added_before_the_encoder(magnet: Plant, level: Level) -> None:
    encoder, noise = Encoder(1e-5), np.random.default_rng(4).normal(0, 3e-5, 300)
    changed = replace(BASE, encoders={"gap": encoder}, noise={"gap": noise})
    trajectory = closed_loop.simulate(magnet, level("float64"), changed)
    assert np.array_equal(trajectory.measured["gap"], encoder.read(trajectory.outputs["gap"] + noise))
    assert 2e-5 < np.std(trajectory.measured["gap"] - trajectory.outputs["gap"]) < 4e-5


@pytest.mark.parametrize("scalar", ["float32", "float64"])
def test_replay_of_what_was_measured_gives_the_same_bits(magnet: Plant, level: Level, scalar: str) -> None:
    controller, references = level(scalar), {"gap_ref": 0.02 + 1e-4 * np.sin(np.arange(300) / 10)}
    trajectory = closed_loop.simulate(magnet, controller, replace(BASE, references=references))
    again = controller.replay(trajectory.measured)
    assert again.outputs["current"].tobytes() == trajectory.commands["current"].tobytes()
    assert again.faults.tobytes() == trajectory.faults.tobytes()
    assert int(again.state["ticks"]) == 300


def test_overridden_samples_arrive_bit_for_bit(magnet: Plant, level: Level) -> None:
    bits = np.zeros(300, np.uint32)
    bits[[50, 51, 60]] = 0x7FA12345, 0xFF800000, 0x00000001  # a signalling NaN, -infinity, the least subnormal
    mask = bits != 0
    scenario = replace(BASE, overrides={"gap": Override(mask, bits.view(np.float32))})
    trajectory = closed_loop.simulate(magnet, level("float32"), scenario)
    assert np.array_equal(trajectory.measured["gap"].view(np.uint32)[mask], bits[mask])
    assert np.array_equal(trajectory.faults != 0, mask)
    assert np.array_equal(trajectory.measured["gap"][~mask], trajectory.outputs["gap"].astype(np.float32)[~mask])
    assert np.isfinite(trajectory["q"]).all()


def test_overridden_set_points(mass: Plant, level: Level) -> None:
    scenario = replace(BASE, overrides={"gap_ref": Override(np.arange(300) == 7, np.full(300, 1e300))})
    assert np.isinf(closed_loop.simulate(mass, level("float32"), scenario).measured["gap_ref"][7])


def falling(**changes: Any) -> Scenario:
    free = replace(BASE, actuators={}, forcing={"i": 0.0, "j": 0.0}, x0={"q": 0.02})
    return replace(free, **changes)


def test_a_stop_takes_the_speed_out(magnet: Plant, level: Level) -> None:
    scenario = falling(stops={"q": (0.01, 0.03)}, substeps=40)
    trajectory = closed_loop.simulate(magnet, level("float64"), scenario)
    fall = np.sqrt(2 * 0.01 / 9.81)
    before, after = trajectory.time < fall - T, trajectory.time > fall + T
    assert np.allclose(trajectory["q"][before], 0.02 + 9.81 / 2 * trajectory.time[before] ** 2, atol=1e-12)
    assert (trajectory["q"][after] == 0.03).all() and (trajectory["v"][after] == 0).all()
    assert trajectory.impacts["q"] == pytest.approx(9.81 * fall, rel=2e-3)


def test_a_mass_leaves_its_stop_when_pulled_off(mass: Plant, level: Level) -> None:
    push = replace(BASE, x0={"q": 0.02}, references={"gap_ref": np.where(np.arange(300) < 100, 0.05, 0.01)})
    trajectory = closed_loop.simulate(mass, level("float64"), replace(push, stops={"q": (0.01, 0.025)}))
    assert (trajectory["q"][60:100] == 0.025).all()
    assert trajectory["q"][160] < 0.024 and trajectory["q"].min() >= 0.01
    unstopped = closed_loop.simulate(mass, level("float64"), push)
    assert unstopped["q"].max() > 0.03 and not unstopped.impacts


def test_the_lower_stop_records_the_speed_of_the_impact(mass: Plant, level: Level) -> None:
    scenario = falling(x0={"q": 0.02, "v": -0.5}, stops={"q": (0.01, 0.03)})
    trajectory = closed_loop.simulate(mass, level("float64"), scenario)
    assert trajectory.impacts == {"q": 0.5} and trajectory["q"][-1] == 0.01 and trajectory["v"][-1] == 0


def test_a_stop_leaves_the_speed_away_from_it(mass: Plant, level: Level) -> None:
    # 10 m/s^2 turn -6 mm/s round within one step of 1 ms, which ends 1 um below the stop.
    scenario = falling(
        x0={"q": 0.01, "v": -6e-3}, forcing={"i": -20.0, "j": 0.0}, stops={"q": (0.01, 0.03)}, substeps=1
    )
    trajectory = closed_loop.simulate(mass, level("float64"), scenario)
    assert trajectory["q"][1] == 0.01 and trajectory["v"][1] == pytest.approx(4e-3)
    assert trajectory["q"][2] == pytest.approx(0.01 + 9e-6)


def test_locked_coordinates_stay(mass: Plant, level: Level) -> None:
    scenario = replace(BASE, forcing={"j": 3.0}, x0={"q": 0.021, "s": 0.5}, locked=["s"])
    trajectory = closed_loop.simulate(mass, level("float64"), scenario)
    assert (trajectory["s"] == 0.5).all() and (trajectory["w"] == 0).all() and np.ptp(trajectory["q"]) > 1e-4
    free = closed_loop.simulate(mass, level("float64"), replace(scenario, locked=()))
    assert free["s"][-1] == pytest.approx(0.5 + 1.5 / 2 * 0.299**2)


def test_actuators_may_mix_commands_and_forcing(mass: Plant, level: Level) -> None:
    rows = {"j": {"trim": 0.5, "current": 0.25}, "i": "current"}
    scenario = replace(BASE, actuators=rows, forcing={"j": 2.0}, references={"gap_ref": np.linspace(0.02, 0.021, 300)})
    trajectory = closed_loop.simulate(mass, level("float64"), scenario)
    current, trim = trajectory.commands["current"][:-1], trajectory.commands["trim"][:-1]
    assert np.array_equal(trajectory.applied["i"], [0, *current])
    assert np.allclose(trajectory.applied["j"], [2.0, *(2.0 + 0.5 * trim + 0.25 * current)], rtol=1e-15)


def test_an_infinite_command_reaches_only_connected_inputs(mass: Plant, level: Level) -> None:
    scenario = replace(BASE, actuators={"i": "current", "j": "overflow"}, hold={"current": 1.5})
    trajectory = closed_loop.simulate(mass, level("float64"), scenario)
    assert np.isinf(trajectory.applied["j"][1:]).all()
    assert gap_error(trajectory, recursion(300, 1, 1.5)) < 1e-11


def test_disturbance_depends_on_state_and_time(mass: Plant, level: Level) -> None:
    x, t = ca.SX.sym("x", 4), ca.SX.sym("t")
    extra = ca.Function("extra", [x, t], [ca.vertcat(0, -30 * x[1], 0, ca.cos(20 * t))])
    scenario = falling(x0={"q": 0.02, "v": 0.1})
    trajectory = closed_loop.simulate(mass, level("float64"), scenario, extra)
    assert np.allclose(trajectory["v"], 0.1 * np.exp(-30 * trajectory.time), atol=1e-8)
    assert np.allclose(trajectory["s"], (1 - np.cos(20 * trajectory.time)) / 400, atol=1e-10)
    with pytest.raises(WiringError, match="disturbance"):
        closed_loop.simulate(mass, level("float64"), scenario, ca.Function("extra", [x], [x]))


def test_an_input_is_forced_by_a_time_series_and_by_a_function_of_time(mass: Plant, level: Level) -> None:
    """A carriage of 2 kg under 3 N, held over each sample or read in the middle of each substep."""
    series = np.where(np.arange(300) < 100, 3.0, 0.0)
    trajectory = closed_loop.simulate(mass, level("float64"), replace(BASE, forcing={"j": series}))
    speed = np.minimum(trajectory.time, 0.1) * 3.0 / 2.0
    assert np.allclose(trajectory["w"], speed, rtol=0, atol=1e-12) and np.array_equal(trajectory.applied["j"], series)
    moving = replace(BASE, forcing={"j": lambda t: 3.0 * math.sin(20 * t)}, substeps=40)
    trajectory = closed_loop.simulate(mass, level("float64"), moving)
    assert np.allclose(trajectory["w"], 3 / 40 * (1 - np.cos(20 * trajectory.time)), rtol=0, atol=3e-9)
    coarse = closed_loop.simulate(
        mass, level("float64"), replace(moving, forcing={"j": 3 * np.sin(20 * trajectory.time)})
    )
    assert np.abs(coarse["w"] - trajectory["w"]).max() > 1e-5


def test_forcing_is_added_to_what_is_commanded_in_each_substep(mass: Plant, level: Level) -> None:
    """An actuated input that is forced as well: with two samples of delay the command waits, the force does not."""
    still = replace(BASE, delay=2, hold={"current": 1.5})
    free = closed_loop.simulate(mass, level("float64"), still)
    trajectory = closed_loop.simulate(
        mass, level("float64"), replace(still, forcing={"i": np.full(300, 0.25), "j": 0.0})
    )
    assert trajectory.applied["i"][0] == 1.75 and trajectory.applied["i"][1] == 1.75 and free.applied["i"][0] == 1.5
    assert np.array_equal(trajectory.applied["i"][2:], trajectory.commands["current"][:-2] + 0.25)


@pytest.mark.parametrize("scalar", ["float32", "float64"])
def test_sensor_errors_are_those_declared(magnet: Plant, level: Level, scalar: str) -> None:
    controller = level(scalar)
    analogue = Analogue(0.0, 0.04, bits=12, noise=2e-5, offset=1e-5, gain_error=1e-3, seed=5)
    wrapping = Encoder(1e-6, span=3e-4, low=0.0207)
    for sensor in (
        wrapping,
        Encoder(0.0, 1e-5, -1e-3),
        Encoder(1e-6, 2e-5, 1e-3),
        analogue,
        replace(analogue, low=0.0208),
    ):
        trajectory = closed_loop.simulate(magnet, controller, replace(BASE, encoders={"gap": sensor}))
        noise = sensor.noise_of(300, 0) / (1 + sensor.gain_error)
        assert np.array_equal(
            trajectory.measured["gap"][:3], sensor.read(trajectory["q"] + noise).astype(controller.scalar)[:3]
        )
        near = np.abs(trajectory.measured["gap"] - sensor.read(trajectory["q"] + noise))
        assert near.max() < 1.1 * max(sensor.chain[2], 1e-8), sensor
        assert trajectory.measured["gap"].min() >= controller.scalar(sensor.chain[3])


def test_a_perturbed_plant_needs_no_compiler(
    magnet: Plant, level: Level, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    controller = level("float64")
    monkeypatch.setenv("SYNTH_CACHE", str(tmp_path))
    speeds = [closed_loop.simulate(magnet.with_parameters(m=m), controller, falling())["v"][-1] for m in (2.0, 4.0)]
    assert len(list(tmp_path.iterdir())) == 1
    pulled = closed_loop.simulate(magnet.with_parameters(m=4.0), controller, falling(forcing={"i": 1.0, "j": 4.0}))
    assert speeds == pytest.approx([9.81 * 0.299] * 2)
    assert pulled["w"][-1] == pytest.approx(0.299) and pulled["v"][-1] < speeds[1]


def test_outputs_are_taken_with_the_input_of_the_interval_before(mass: Plant, level: Level) -> None:
    trajectory = closed_loop.simulate(mass, level("float64"), replace(BASE, hold={"current": 1.25}))
    assert np.array_equal(trajectory["lift"], -np.array([1.25, *trajectory.applied["i"][:-1]]))


def test_a_trajectory_is_read_by_name_and_not_written(mass: Plant, level: Level) -> None:
    trajectory = closed_loop.simulate(mass, level("float64"), BASE)
    assert trajectory["gap"] is trajectory.outputs["gap"] and len(trajectory.time) == 300
    with pytest.raises(ValueError, match="read-only"):
        trajectory["q"][0] = 0.0
    with pytest.raises(SignalError, match=r"'gasp'.*gap_ref"):
        trajectory["gasp"]


@pytest.mark.parametrize(
    ("changes", "error", "says"),
    [
        ({"x0": {"v": 0.0}}, SignalError, "'q', whose range"),
        ({"x0": {"q": 0.02, "u": 0.0}}, SignalError, "initial plant states x0: 'u' is not one of q, v, s, w"),
        ({"sensors": {"gap": "height"}}, SignalError, "'height' is not one of gap, lift"),
        ({"sensors": {"gap": "lift"}}, WiringError, "in m, plant signal 'lift'"),
        ({"sensors": {}}, WiringError, "'gap' has 0 sources"),
        ({"references": {"gap_ref": 0.02, "gap": 0.0}}, WiringError, "'gap' has 2 sources"),
        ({"references": {"gap_ref": np.zeros(299)}}, SignalError, r"\(299,\), need \(300,\)"),
        ({"forcing": {}}, WiringError, "plant input 'j' has no source"),
        ({"forcing": {"j": np.zeros(299)}}, SignalError, r"forcing of 'j' is an array \(299,\): give .* in A, 300 of"),
        ({"forcing": {"j": np.zeros((300, 4))}}, SignalError, r"forcing of 'j' is an array \(300, 4\)"),
        ({"forcing": {"j": np.full(300, np.nan)}}, SignalError, "forcing of 'j' is not finite: give"),
        ({"forcing": {"j": lambda t: np.inf}}, SignalError, "forcing of 'j' is not finite: give"),
        ({"forcing": {"j": "hum"}}, SignalError, "forcing of 'j' is not a number at some time"),
        ({"forcing": {"j": lambda t: [t]}}, SignalError, "forcing of 'j' is not a number at some time"),
        ({"forcing": {"j": 0.0, "k": np.zeros(300)}}, SignalError, "forcing: 'k' is not one of i, j"),
        ({"actuators": {"i": "voltage"}}, SignalError, "'voltage' is not one of current, overflow, trim"),
        ({"hold": {"voltage": 0.0}}, SignalError, "hold: 'voltage'"),
        ({"encoders": {"gap_ref": Encoder(1e-5)}}, SignalError, "encoders: 'gap_ref'"),
        ({"noise": {"gap_ref": np.zeros(300)}}, SignalError, "noise: 'gap_ref'"),
        ({"noise": {"gap": np.full(300, np.nan)}}, SignalError, "300 finite numbers"),
        ({"noise": {"gap": 0.0}}, SignalError, r"noise of 'gap' has the shape \(\)"),
        ({"overrides": {"gap": Override(np.zeros(3, bool), 0.0)}}, SignalError, "override mask of 'gap'"),
        ({"velocities": {"q": "u"}}, SignalError, "velocities: 'u'"),
        ({"stops": {"v": (0.0, 1.0)}}, SignalError, "stops: 'v'"),
        ({"stops": {"q": (0.03, 0.04)}}, SignalError, "not within its stops"),
        ({"locked": ["v"]}, SignalError, "locked: 'v'"),
        ({"duration_s": 0.0}, SignalError, "duration is 0.0 s"),
    ],
)
def test_invalid_arguments_are_named(
    mass: Plant, level: Level, changes: dict[str, Any], error: type[Exception], says: str
) -> None:
    with pytest.raises(error, match=says):
        closed_loop.simulate(mass, level("float64"), replace(BASE, **changes))


def test_a_scenario_refuses_negative_delay_and_no_substep() -> None:
    for changes in ({"delay": -1}, {"substeps": 0}):
        with pytest.raises(SignalError, match="at least"):
            replace(BASE, **changes)
