"""The table of failures in the header: its rows follow from the declarations and numbers of the Blocks."""

from dataclasses import replace

import numpy as np
import pytest

from designs.maglev import fault_handling, platen
from designs.maglev_5dof.design import DESIGN, PLANT
from synth import plant as plants
from synth.blocks.faults import redundancy
from synth.declare import actuation
from synth.emit.c import header
from synth.errors import SignalError
from synth.fault import with_reactions
from synth.signals import Signal
from synth.stage import Interface
from tests.emit.c.test_manifest import stage


def test_a_row_names_the_bits_and_the_samples_of_the_guard() -> None:
    said = "\n".join(header.failure_rows(stage()))
    assert "bit 0; in that sample" in said
    assert "3 samples in a row, of any of them: latches" in " ".join(f.reaction for f in stage().failures)
    assert header.failure_rows(replace(stage(), failures=())) == []
    assert max(map(len, header.failure_rows(stage()))) <= 117


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
    signs = actuation.signs(PLANT, DESIGN.velocities, {"y": 0.025})
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
        assert actuation.signs(pulls, {"z": "v"}, at) == {"upper": "+z", "lower": "-z"}
