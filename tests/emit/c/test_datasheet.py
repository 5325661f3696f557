"""The datasheet beside the C: its rows follow from the declarations and numbers of the Blocks."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from designs.maglev import fault_handling, platen
from designs.maglev_5dof.design import DESIGN, PLANT
from synth import plant as plants
from synth.app import standard_tasks
from synth.block import Block, Constant
from synth.blocks.faults import redundancy
from synth.emit.c import datasheet
from synth.emit.write import emit
from synth.errors import SignalError
from synth.fault import with_reactions
from synth.show import Sheet
from synth.signals import Signal
from synth.stage import Interface
from tests.emit.c.test_header import GENERATED, NAMES, committed
from tests.emit.c.test_manifest import stage
from tests.emit.passes.test_guards import F32


def sections(block: Block, numbers: tuple[Constant, ...] = ()) -> dict[str, Sheet]:
    """Return the sections of a datasheet by title."""
    return {s.title: s for s in datasheet.sheets(block, datasheet.Facts(numbers, (), (), "float32"))}


def text_of(name: str) -> str:
    return (GENERATED / name / f"{name}.md").read_text(encoding="utf-8")


def test_a_row_names_the_bits_and_the_samples_of_the_guard() -> None:
    said = emit(stage(), F32).files["stage.md"]
    assert "| bit 0; in that sample |" in said
    assert "3 samples in a row, of any of them: latches" in said
    assert not any(s.tables for s in sections(replace(stage(), failures=())).values())


def test_notes_and_a_warning_stand_in_it() -> None:
    said = emit(stage(), F32, datasheet_notes=["(n) is equation (n)."], warning="no protection.").files["stage.md"]
    assert said.startswith("# stage: no protection.\n") and "\n- (n) is equation (n).\n" in said
    assert "(n)" not in emit(stage(), F32).files["stage.md"]


def test_numbers_are_those_of_the_decision() -> None:
    names, relations = platen.INTERFACE.signals, fault_handling.relations(PLANT)
    sensors = [names[n] for n in fault_handling.SENSORS]
    for persistent in (3, 5):
        decision = replace(fault_handling.DECISION, persistent=persistent)
        made = redundancy.block(platen.TIME, sensors, relations, decision)
        row = next(f for f in made.failures if f.key == "one_wrong")
        assert f"{relations[0].threshold:g} m in {persistent} samples in a row" in row.noticed
        assert row.suspects == ("y1", "y2", "y3", "y4")


def test_a_stage_adds_its_words_by_key_and_an_unknown_key_is_refused() -> None:
    failures = stage().failures
    first, second = with_reactions(failures, {failures[0].key: "all axes go on"}, {failures[1].key: "a guess"})[:2]
    assert first.reaction == f"{failures[0].reaction}; all axes go on" and first.instead == failures[0].instead
    assert second.reaction == failures[1].reaction and second.instead == "a guess" != failures[1].instead
    for words in ({"unknown": ""}, {}), ({}, {"unknown": ""}):
        with pytest.raises(SignalError, match="no failure 'unknown'"):
            with_reactions(failures, *words)


def test_the_maglev_stage_says_where_currents_and_angles_end() -> None:
    declared = DESIGN
    assert declared is not None and isinstance(declared.interface, Interface)
    said = " ".join(declared.reactions.values())
    assert "the lost position is 0.2 m, which the phase step refuses" in said and "motors 2 and 4 hand i_d over" in said


def test_signs_of_the_actuators_come_from_the_plant() -> None:
    assert DESIGN is not None
    signs = standard_tasks.actuator_signs(PLANT, DESIGN.velocities, {"y": 0.025})
    assert signs["i_d1"] == "+y -phi" and signs["i_d2"] == "+y +theta" and (signs["u_x"], signs["u_z"]) == ("-x", "-z")
    turned = {name: "".join({"+": "-", "-": "+"}.get(c, c) for c in sign) for name, sign in signs.items()}
    assert np.all([signs[n] != turned[n] for n in signs])


def test_a_pull_with_the_square_of_a_current_has_a_sign_at_0_A() -> None:
    states = [Signal("z", "m", -1e-3, 1e-3), Signal("v", "m/s", -1.0, 1.0)]
    coils = [Signal("upper", "A", 0.0, 4.0), Signal("lower", "A", 0.0, 4.0)]
    pulls = plants.build(
        "coils", states, coils, states[:1], [],
        lambda x, u, p: ({"z": x["v"], "v": u["upper"] ** 2 - u["lower"] ** 2}, {"z": x["z"]}),
    )  # fmt: skip
    for current in (0.0, 1.0):
        at = {"upper": current, "lower": current}
        assert standard_tasks.actuator_signs(pulls, {"z": "v"}, at) == {"upper": "+z", "lower": "-z"}


@pytest.mark.parametrize("name", NAMES)
def test_the_datasheet_states_the_initial_value_of_each_input(name: str) -> None:
    """They are those of init, which a value that differs would contradict."""
    text, fields = text_of(name), json.loads((GENERATED / name / "manifest.json").read_text())["structs"]
    source = committed(name)[f"{name}.c"]
    of_guard = re.search(r"\.guard = \{(.*?)\}", source, re.DOTALL)
    initial = dict(re.findall(r"\.(?:guard_)?last_(\w+) = ([-\d.e]+)f", of_guard[1] if of_guard else source))
    safety = json.loads((GENERATED / name / "manifest.json").read_text()).get("safety") or {}
    replaced = safety.get("judgement", {}).get("measurements", ())  # by what the others or a prediction say
    kept = [f["name"].removeprefix("guard_last_") for f in fields["state"]["fields"] if "guard_last_" in f["name"]]
    kept = [n for n in kept if n not in replaced]
    inputs = {f["name"]: f["name"].removesuffix("_commutation") for f in fields["input"]["fields"]}
    sentence = re.search(
        r"A refused input is replaced by its last good value, and before its first good value by (.*?)[;.]\s", text
    )
    assert bool(sentence) == bool(kept)
    stated = {
        inputs[n]: float(value)
        for value, names in re.findall(r"([-\d.e]+) \S+ \(([^)]*)\)", sentence[1] if sentence else "")
        for n in names.split(", ")
    }
    assert {n: stated[n] for n in kept} == {n: float(initial.get(n, 0.0)) for n in kept}


def test_it_says_what_is_used_instead_of_a_voltage() -> None:
    rows = [r.split(" | ") for r in text_of("planar_6dof_lqg").splitlines() if r.startswith("| ")]
    used = [r[2] for r in rows if len(r) == 4]
    predicted = "none of the six voltages: x, y and yaw are predicted (dead reckoning)"
    assert used.count(predicted) == 2 and "initial value" not in used
    assert " by 0 V" not in text_of("planar_6dof_lqg")


def test_it_says_which_constants_follow_from_which_parameter() -> None:
    numbers = (
        Constant("half_M_y", 3.45, "kg", "M_y / 2", parameters=("M_y",)),
        Constant("M_x", 10.6, "kg", "Table I", parameters=("M_x",)),
        Constant("inverse_M_x", 1 / 10.6, "1/kg", "1 / M_x", parameters=("M_x",)),
        Constant("half_I", 0.5, "kg m", "I_x / 2; of x, z", parameters=("I_x", "I_z")),
        Constant("limit", 7.0, "A", "no parameter of the plant"),
    )
    (table,) = sections(stage(), numbers)["Constants and parameters"].tables
    assert table.rows == (("M_x", "M_x, inverse_M_x"), ("I_x, I_z", "half_I"), ("M_y", "half_M_y"))
    assert "Constants and parameters" not in sections(stage(), numbers[-1:])


def test_a_constant_of_a_plant_knows_its_parameters_and_so_does_one_for_several() -> None:
    text = text_of("maglev_5dof")
    assert "| M_x | M_x, inverse_M_x |" in text and "| I_x, I_z | half_I_over_r |" in text


def test_a_product_of_constants_has_the_parameters_of_both() -> None:
    shares = "allocation_front_share, allocation_rear_share, {}, loop_z_integral_input_times_allocation_z_share"
    assert all(f"| {arm} | {shares.format(arm)} |" in text_of("planar_6dof_lqg") for arm in "bc")


def test_a_bar_in_a_cell_does_not_end_it() -> None:
    assert "&#124;residual&#124; above" in text_of("maglev_5dof")
