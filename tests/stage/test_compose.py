"""What surrounds the laws of a stage follows from the plant's signals, and each part of a design can be replaced."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth import analyse, stage
from synth import plant as plants
from synth.app import standard_tasks, verdicts
from synth.base.progress import silent
from synth.block import Block, Exprs, Step, build
from synth.blocks.laws import axis
from synth.declare.stage import Stage
from synth.errors import DesignError, SignalError, WiringError
from synth.execute import host
from synth.signals import Signal
from synth.stage import Actuator, Companion, Drive, FaultCampaign, Sensor, SetPoint, compose
from synth.timing import Discrete
from synth.verify import standard, stimuli
from tests import levitator

PID = levitator.design()
SENSORS = [Sensor("z"), Sensor("x_read", of="x", high=5e-4, initial=1e-4, about="from the left")]
POINTS = [SetPoint("z_ref", of="z", low=1e-4, high=5e-4)]
ACTUATORS = [Actuator("i1", 0.0, 100.0), Actuator("coil", 0.0, 50.0, of="i2", low=-1.0)]


CARRIAGE = plants.build(
    "carriage",
    [Signal("q", "m", -5e-3, 5e-3), Signal("v", "m/s", -1.0, 1.0)],
    [Signal("f", "N", -20.0, 20.0)],
    [Signal("q", "m", -5e-3, 5e-3)],
    [],
    lambda x, u, p: ({"q": x["v"], "v": u["f"] - 50.0 * x["q"]}, {"q": x["q"]}),
)


def around(**changed: Any) -> stage.Interface:
    declared = {"sensors": SENSORS, "set_points": POINTS, "actuators": ACTUATORS, "disturbances": ["hum"]}
    return stage.interface(PID.PLANT, **(declared | changed))


def test_names_units_and_ranges_come_from_the_plant() -> None:
    interface = around()
    ranges = {name: (s.unit, s.low, s.high) for name, s in interface.signals.items()}
    assert ranges == {
        "z": ("m", -6e-4, 6e-4),
        "x_read": ("m", -1e-3, 5e-4),
        "z_ref": ("m", 1e-4, 5e-4),
        "i1": ("A", -3, 3),
        "coil": ("A", -1.0, 2),
    }
    assert [s.name for s in interface.inputs] == ["z", "x_read", "z_ref"] and interface.set_points[0].initial == 1e-4
    error = interface.error("z")
    assert (error.name, error.low, error.high) == ("z_error", pytest.approx(-5e-4), pytest.approx(11e-4))
    assert interface.signals["coil"].about == "voice coil" and interface.signals["x_read"].about == "from the left"


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"sensors": [Sensor("y")]}, "plant 'levitator' has no output 'y': name one of z, x"),
        ({"set_points": [SetPoint("r", of="y", low=0, high=1)]}, "no output or state 'y'"),
        ({"actuators": [Actuator("i3", 0.0, 1.0)]}, "no input 'i3'"),
        (
            {"actuators": [Actuator("i1", 0.0, 1.0, high=30.0)]},
            r"'i1' may be -3 .. 30 A, beyond the range of the plant input 'i1', -3 .. 3: give it a range inside",
        ),
        ({"actuators": [Actuator("i1", None, 1.0)]}, "'i1' has safe = None: give a number in A"),  # type: ignore[arg-type]
        (
            {"actuators": [Actuator("i1", 3.5, 1.0)]},
            r"'i1' has the safe value 3.5, outside -3 .. 3 A: choose one inside",
        ),
        ({"actuators": [Actuator("i1", np.nan, 1.0)]}, r"'i1' has the safe value nan, outside -3 .. 3 A"),
        ({"actuators": [Actuator("i1", 0.5, 1.0, high=0.4)]}, r"safe value 0.5, outside -3 .. 0.4 A"),
        ({"actuators": [Actuator("i1", 0.0, 1.0, landed=-4.0)]}, r"'i1' has the safe value -4, outside -3 .. 3 A"),
        ({"disturbances": ["wind"]}, "no input 'wind'"),
        ({"disturbances": []}, "plant input 'hum' is driven by nothing"),
        ({"sensors": [*SENSORS, Sensor("z")]}, "'z' is declared 2 times"),
    ],
)
def test_what_the_plant_does_not_have_is_refused_by_name(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(SignalError, match=message):
        around(**changed)


@pytest.mark.parametrize(
    ("sensor", "message"),
    [
        (Sensor("z", resolution=50), "'z' has a resolution of 50 m in a range of -0.0006 .. 0.0006 m: give one from 0"),
        (Sensor("z", resolution=-1e-8), "'z' has a resolution of -1e-08 m"),
        (Sensor("z", noise=-1e-8), "sensor 'z' has noise of -1e-08 m in a range of"),
        (Sensor("z", offset=-1e-6), "sensor 'z' has offset = -1e-06: give its largest size in m, finite, from 0 on"),
        (Sensor("z", wraps=-1e-3), "sensor 'z' wraps after -0.001 m, with high = None: give a finite span above 0"),
        (Sensor("z", wraps=1e-3, high=1e-3), "sensor 'z' wraps after 0.001 m, with high = 0.001: .* and no high"),
        (Sensor("z", gain_error=np.nan), "sensor 'z' has gain_error = nan: give its largest size in 1, finite"),
    ],
)
def test_a_resolution_or_noise_that_no_sensor_has_is_refused(sensor: Sensor, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        around(sensors=[sensor])


def test_a_sensor_that_wraps_has_the_range_of_its_span_and_no_error_of_its_own() -> None:
    interface = around(sensors=[*SENSORS, Sensor("turn", of="z", wraps=2e-4, low=-1e-4), Sensor("b", of="x", wraps=1)])
    assert [(interface.signals[n].low, interface.signals[n].high) for n in ("turn", "b")] == [(-1e-4, 1e-4), (0, 1)]
    with pytest.raises(SignalError, match="'turn' is no sensor with a set-point"):
        interface.error("turn")


@pytest.mark.parametrize("delay", [-1, 0.5])
def test_a_delay_counts_whole_samples(delay: Any) -> None:
    with pytest.raises(SignalError, match=f"the delay is {delay} samples: give a whole number from 0"):
        around(delay=delay)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"require": {"disk_margin": float("nan")}}, "the least disk_margin is NaN, which no loop reaches"),
        ({"require": {"gain": 2.5}}, "'gain' is not a margin: name one of phase_margin, gain_margin"),
        ({"tolerances": ["mass"]}, "no parameter 'mass': it has"),
    ],
)
def test_a_requirement_is_refused_where_it_is_declared(changed: dict[str, Any], message: str) -> None:
    with pytest.raises(SignalError, match=message):
        stage.design(PID.DESIGN.controller, PID.PLANT, reference=PID.reference.step, **changed)


def test_a_set_point_without_a_sensor_has_no_error() -> None:
    with pytest.raises(SignalError, match="'x_read' is no sensor with a set-point"):
        around().error("x_read")


def test_a_set_point_may_name_the_plant_output_behind_a_sensor_of_another_name() -> None:
    sensors = [Sensor("probe", of="x", resolution=1e-7), Sensor("z", resolution=1e-7)]
    points = [SetPoint("z_ref", of="z", low=-5e-4, high=5e-4), SetPoint("x_ref", of="x", low=-5e-4, high=5e-4)]
    assert around(sensors=sensors, set_points=points).error("probe").name == "probe_error"


def test_the_laws_are_composed_with_guard_errors_limits_and_safe_output() -> None:
    made = PID.DESIGN.controller
    assert [b.name for b in made.parts] == ["guard", "errors", "pid_z", "pid_x", "limits", "safe_output"]
    assert [s.name for s in made.block.inputs] == ["z", "x", "z_ref", "x_ref"]
    assert [s.name for s in made.block.outputs] == ["i1", "i2"]
    assert made.block.safety is not None and made.block.safety.bad_samples == 4
    assert dict(made.block.safety.slew_per_s) == {"i1": 100.0, "i2": 100.0}


def test_a_law_without_its_actuator_is_refused() -> None:
    with pytest.raises(WiringError, match="'i2_computed' is needed by 'safe_output'"):
        stage.controller("one", PID.TIME, PID.INTERFACE, [PID.pid("z")]).block  # noqa: B018


def test_once_latched_the_laws_stand_still_and_the_outputs_go_to_their_safe_values() -> None:
    controller = standard_tasks.compiled_controller(PID.DESIGN, np.float64)
    n = 100
    held = {"z": np.full(n, 1e-4), "x": np.full(n, 5e-4), "z_ref": np.zeros(n), "x_ref": np.full(n, 8e-4)}
    held["z"][20:] = np.nan
    replay = controller.replay(held)
    assert np.argmax(replay.faults >> 31) == 23 and replay.outputs["i2"][22] > 0.1
    assert np.abs(np.diff(replay.outputs["i2"][22:])).max() == pytest.approx(100 / 2000)
    assert replay.outputs["i1"][-1] == replay.outputs["i2"][-1] == 0


def test_a_stage_without_reference_is_refused_where_it_is_verified() -> None:
    """Its margins need none: they come first."""
    alone = stage.design(PID.DESIGN.controller, PID.PLANT, operating_points={"mid": {}})
    assert verdicts.stability(verdicts.closed_loops(alone)) == "stable in 1 case"
    with pytest.raises(DesignError, match="give `reference`, a NumPy step"):
        standard.verify(alone, silent, False)


def test_test_vectors_are_a_closed_loop_up_to_the_latch() -> None:
    files = standard_tasks.emit(PID.DESIGN, np.float32)["levitator_pid"]
    written = {f"levitator_pid.{kind}" for kind in ("c", "h", "md")}
    assert set(files.files) == {*written, "manifest.json", "gains.json", "vectors.json"}
    controller = host.load(files.files, files.manifest)
    inputs = standard_tasks.record(standard_tasks.rig(PID.DESIGN, np.float32))
    faults = controller.replay(inputs).faults
    assert len(faults) == 1000 and faults[-1] >> 31 and not faults[:900].max() >> 31
    assert all(np.isfinite(column).all() for column in inputs.values())


def test_the_errors_are_set_point_less_measurement() -> None:
    block = compose.errors(PID.TIME, PID.INTERFACE, ["z"])
    f = ca.Function("f", [block.symbol[s.name] for s in block.inputs], [block.output["z_error"]])
    assert [s.name for s in block.inputs] == ["z_held", "z_ref_held"]
    assert float(f(1e-4, 3e-4)) == pytest.approx(2e-4)


def test_a_variant_of_the_interface_makes_another_controller() -> None:
    slower = replace(PID.INTERFACE, bad_samples=7)
    made = stage.controller("slow", PID.TIME, slower, [PID.pid("z"), PID.pid("x")])
    assert made.block.safety is not None and made.block.safety.bad_samples == 7


def design_with(**fields: Any) -> Any:
    return stage.design(PID.DESIGN.controller, PID.PLANT, **({"reference": PID.reference.step} | fields))


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"stop": {"z": (-6e-4, 6e-4)}}, "a stage has no field 'stop': give some of reference, .*stops"),
        ({"reference": PID.reference}, "the reference of design 'levitator_pid' is a module: give its step function"),
    ],
)
def test_a_field_that_cannot_be_is_refused_where_it_is_declared(fields: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        design_with(**fields)


def test_a_set_point_beyond_a_stop_is_refused() -> None:
    points = {s.name: (s.low, s.high) for s in PID.DESIGN.interface.set_points}
    low, high = points["z_ref"]
    assert design_with(stops={"z": (low, high)}).stops == {"z": (low, high)}
    with pytest.raises(SignalError, match=r"'z_ref' may be .* m, beyond the distance between the stops of 'z'"):
        design_with(stops={"z": (low, 0.9 * high)})


def test_a_set_point_beyond_the_range_of_its_sensor_is_refused() -> None:
    wide = around(set_points=[SetPoint("z_ref", of="z", low=-1e-3, high=1e-3)])
    made = replace(PID.DESIGN.controller, interface=wide)
    with pytest.raises(SignalError, match=r"0\.001 m, beyond the range of its sensor 'z', -0\.0006"):
        stage.design(made, PID.PLANT, reference=PID.reference.step)


def test_the_error_of_an_output_is_that_of_the_sensor_that_reads_it() -> None:
    points = [SetPoint("x_ref", of="x", low=0.0, high=1e-4)]
    with pytest.raises(SignalError, match=r"'x' is no sensor .*: declare both, or take one of x_read"):
        around(set_points=points).error("x")


def test_a_recorded_loop_that_diverges_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    made = PID.DESIGN
    rig = standard_tasks.rig(made, made.scalar)
    run = stimuli.closed_loop(rig, 10)
    columns = {name: column.copy() for name, column in run.measured.items()}
    columns["z"][4:] = -np.inf
    monkeypatch.setattr(stimuli, "closed_loop", lambda *arguments: replace(run, measured=columns))
    with pytest.raises(DesignError, match=r"diverges: 'z' is -inf in sample 4; check the period of 0\.000"):
        standard_tasks.record(rig)


def bridges(name: str) -> Block:
    """Return a Block behind the controller, from its first current to a voltage."""
    coil, bridge = Signal("i1", "A", -3, 3), Signal("bridge", "V", -3, 3)

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        return Step({"bridge": u["i1"]})

    return build(name, PID.TIME, law, inputs=[coil], outputs=[bridge])


COILS = (Signal("i1", "A", -3, 3), Signal("i2", "A", -2, 2))


def distributed(outputs: Mapping[str, Callable[[Exprs], Any]], name: str = "bridges", inputs: Any = COILS) -> Block:
    """Return a Block that computes currents from values of actuators."""
    signals = [Signal(n, "A", -9, 9) for n in outputs]
    return build(
        name, PID.TIME, lambda u, x, k: Step({n: f(u) for n, f in outputs.items()}), inputs=inputs, outputs=signals
    )


def composed(outputs: Sequence[str], *behind: Block) -> Block:
    laws = [PID.pid("z"), PID.pid("x"), *behind]
    return stage.controller("levitator_pid", PID.TIME, PID.INTERFACE, laws, outputs=outputs).block


SUM, DIFFERENCE = {"a": lambda u: u["i1"] + u["i2"]}, {"b": lambda u: u["i1"] - u["i2"]}
TWICE = distributed({"c": lambda u: 2 * u["a"]}, "twice", [Signal("a", "A", -9, 9)])


@pytest.mark.parametrize(
    ("outputs", "behind", "message"),
    [
        (
            ["a", "b"],
            [distributed(SUM | DIFFERENCE)],
            "'a' of 'levitator_pid' has no safe value: the Block 'bridges' .* i1, i2",
        ),
        (["i1", "i2", "b"], [distributed(DIFFERENCE)], "output 'b' .* declare 'b' as the actuator, .* give 'b_demand'"),
        (["i1", "c"], [distributed(SUM), TWICE], "output 'c' .* the Block 'twice' computes it from i1, i2 behind"),
        (
            ["a", "i2"],
            [distributed({"a": lambda u: -u["i1"]}, inputs=COILS[:1])],
            "output 'a' .* computes it from i1 behind",
        ),
        (["i2"], [], "actuator 'i1' of 'levitator_pid' reaches none of the outputs i2, .*: add 'i1' to `outputs`"),
        (["i1", "z_held"], [], "actuator 'i2' .* reaches none of the outputs i1, z_held"),
    ],
)
def test_an_output_without_a_safe_value_is_refused(outputs: Any, behind: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        composed(outputs, *behind)


def test_an_output_that_passes_an_actuator_on_has_its_safe_value() -> None:
    copies = distributed({n: lambda u: u["i1"] for n in ("left", "right")}, inputs=COILS[:1])
    safety = composed(["left", "right", "i2", "z_held"], copies).safety
    assert safety and safety.safe_output == {"left": 0.0, "right": 0.0, "i2": 0.0}


def test_a_block_of_the_drive_that_is_not_emitted_is_refused() -> None:
    block = bridges("bridges")
    driven = Drive(PID.PLANT, (Companion(block.name, lambda: block),))
    with pytest.raises(DesignError, match=r"the Block 'bridges', which is not emitted: add .* to `companions`"):
        design_with(drive=driven)
    assert design_with(drive=driven, companions=driven.companions).drive is driven


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["levitator_pid"], "a Block and the controller are both called 'levitator_pid': rename"),
        (["bridges", "bridges"], "two Blocks beside the controller are called 'bridges': rename one"),
    ],
)
def test_two_blocks_of_one_name_are_refused(names: list[str], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        design_with(companions=[Companion(name, partial(bridges, name)) for name in names])


@pytest.mark.parametrize(
    ("velocities", "message"),
    [
        ({"z": "vz", "x": "z"}, "velocities: the rate of 'x' is 'vx', not 'z'"),
        ({"z": "v"}, "velocities: plant 'levitator' has no state 'v': name one of z, vz, x, vx"),
        ({"vz": "vx"}, "velocities: the rate of 'vz' does not depend on 'vx'"),
    ],
)
def test_a_velocity_that_is_not_the_rate_of_its_position_is_refused(velocities: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        design_with(velocities=velocities)


@pytest.mark.parametrize(
    ("inertias", "message"),
    [
        ({"z": "mass"}, "plant 'levitator' has no parameter 'mass': it has M,"),
        ({"y": "M"}, "inertias: 'y' is not a position with a velocity: name one of z, x"),
    ],
)
def test_an_unknown_inertia_is_refused(inertias: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        design_with(faults=FaultCampaign(inertias=inertias))


@pytest.mark.parametrize(
    ("point", "message"),
    [
        ({"y": 0.0}, "operating point 'high': plant 'levitator' has no state or input 'y': name some of z, vz, x, vx"),
        ({"z": 0.5}, "operating point 'high' has z = 0.5 m, beyond the plant's range of -0.0006 .. 0.0006: choose"),
    ],
)
def test_an_operating_point_that_the_plant_cannot_have_is_refused(point: Any, message: str) -> None:
    assert design_with(operating_points={"low": {"z": -6e-4, "i1": 1.0}})
    with pytest.raises(SignalError, match=message):
        design_with(operating_points={"low": {"z": 0.0}, "high": point})


@pytest.mark.parametrize(
    ("stops", "message"),
    [
        ({"y": (-1.0, 1.0)}, "stops: plant 'levitator' has no state 'y': name some of z, vz, x, vx"),
        ({"z": (-0.6, 0.6)}, "'z' are at -0.6 and 0.6 m, beyond the plant's range of -0.0006 .. 0.0006: choose stops"),
    ],
)
def test_stops_beyond_the_plant_are_refused(stops: Any, message: str) -> None:
    with pytest.raises(SignalError, match=message):
        design_with(stops=stops)


def test_a_stop_at_which_no_sensor_is_in_range_is_refused() -> None:
    narrow, wide = Sensor("z", low=-5e-4, high=5e-4), Sensor("z_coarse", of="z")
    stops = {"z": (-6e-4, 6e-4)}

    def design_of(*sensors: Sensor) -> Any:
        made = replace(PID.DESIGN.controller, interface=around(sensors=[*sensors, SENSORS[1]]))
        return stage.design(made, PID.PLANT, reference=PID.reference.step, stops=stops)

    with pytest.raises(SignalError, match=r"sensor 'z' may be -0.0005 .. 0.0005 m, but 'z' has stops at -0.0006 and"):
        design_of(narrow)
    assert design_of(narrow, wide).stops == stops


def test_a_plant_that_is_too_fast_for_its_runge_kutta_steps_is_refused() -> None:
    """With a damper of c on m the pole is c / m, and the product with a step of T / 4 may be 2."""
    fast = PID.PLANT.with_parameters(c=20e3 * 0.3, s=0.0)
    design = partial(stage.design, PID.DESIGN.controller, fast, reference=PID.reference.step)
    with pytest.raises(DesignError, match=r"a pole of 2e\+04 1/s, .* 4 Runge-Kutta steps, .*: give substeps=5 or more"):
        design()
    assert design(substeps=5).substeps == 5


def test_a_mode_that_the_simulation_would_damp_is_refused() -> None:
    """In each step h of T / 4 the method takes (w h)^6 / 144 of an oscillation at w: 2.3 % at w h = 1.2."""
    w, damping = 9800.0, 5e-4
    stiff = PID.PLANT.with_parameters(s=0.3 * w**2, c=2 * damping * w * 0.3)
    design = partial(stage.design, PID.DESIGN.controller, stiff, reference=PID.reference.step)
    message = r"a mode of 1\.56e\+03 Hz with a damping ratio of 0\.0005, .* 4 Runge-Kutta steps .* substeps=12 or more"
    with pytest.raises(DesignError, match=message):
        design()
    assert design(substeps=12).substeps == 12


def test_a_driven_plant_with_another_parameter_is_refused() -> None:
    block = bridges("bridges")
    driven = Drive(PID.PLANT.with_parameters(K=25.0), (Companion(block.name, lambda: block),))
    with pytest.raises(DesignError, match=r"the plant has K = 20 .*, and the driven plant 25, with which"):
        design_with(drive=driven, companions=driven.companions)


def test_coordinates_name_sensors_and_leave_out_none_that_has_a_set_point() -> None:
    tilt = {"tilt": {"z": 1.0, "x": -1.0}}
    assert design_with(coordinates=tilt).coordinates == tilt
    with pytest.raises(SignalError, match="'tilt' is a sum with 'gap', which is no sensor: name some of z, x"):
        design_with(coordinates={"tilt": {"gap": 1.0}})
    rates = around(set_points=[SetPoint("vz_ref", of="vz", low=-0.1, high=0.1)])
    made = replace(PID.DESIGN.controller, interface=rates)
    with pytest.raises(SignalError, match="'vz', the coordinate of set-point 'vz_ref', is missing"):
        stage.design(made, PID.PLANT, reference=PID.reference.step, coordinates=tilt | {"tilt": {"z": 1.0}})


def test_the_rate_of_a_position_with_a_stop_comes_from_the_model_or_is_asked_for() -> None:
    stops = {"z": (-6e-4, 6e-4)}
    assert design_with(stops=stops).velocities == {"z": "vz"}
    with pytest.raises(SignalError, match="'vz' has stops, but velocities lack it: add the state that is the rate of"):
        design_with(stops={"vz": (-0.1, 0.1)})


def test_a_servo_follows_a_set_point_that_names_the_output_behind_its_sensor() -> None:
    """The sensor has another name; the loop that is composed and simulated is the same."""
    ends = []
    for of in ("q", "probe"):
        made = stage.interface(
            CARRIAGE,
            sensors=[Sensor("probe", of="q", resolution=1e-8)],
            set_points=[SetPoint("r", of=of, low=-2e-3, high=2e-3)],
            actuators=[Actuator("f", safe=0.0, slew_per_s=1e3)],
            delay=1, bad_samples=4, safe_output_effect="stops",
        )  # fmt: skip
        servo = axis.servo(
            analyse.linearise(CARRIAGE, analyse.trim(CARRIAGE, {}, ["f"])), modes={0.0: 20.0},
            weights={"q": 1e8, "v": 1e2},
            command_weight=1e-2, estimator=axis.kalman({"v": 1e-3}, {"q": 1e-14}), anti_windup=30.0,
        )  # fmt: skip
        declared = Stage(stage.controller("carriage", Discrete(1e-3), made, [servo]), CARRIAGE)
        rig = standard_tasks.rig(declared, np.float64)
        ends.append(rig.run(0.5, {"q": 1e-3}, {"r": 5e-4})["q"][-1])
    assert ends[0] == ends[1] == pytest.approx(5e-4, abs=1e-8)


def test_a_header_has_a_sentence_a_paragraph(tmp_path: Path) -> None:
    file = tmp_path / "header.md"
    file.write_text("It rests\non its stop at {stop:g} mm.\n\nThen it lifts.\n")
    assert stage.read_notes(file, stop=31.0) == ["It rests on its stop at 31 mm.", "Then it lifts."]
    for values in ({}, {"stop": 31.0, "gap": 2.0}):
        with pytest.raises(DesignError, match=r"header.md: found values of .*, need those of its .*'stop'"):
            stage.read_notes(file, **values)
