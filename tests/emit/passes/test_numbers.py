"""Named numbers: which literals become constants, under which names, and that the values stay the same."""

import re
from collections.abc import Mapping

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.composition import compose
from synth.emit.write import emit
from synth.execute import host
from synth.law import label
from synth.plant import build as build_plant
from synth.signals import Parameter, Signal
from synth.timing import Discrete

TIME = Discrete(1e-3)
F32 = np.float32
MASS = Constant("mass", 3.45, "kg", "Table I")
X, Y = Signal("x", "m", -1, 1), Signal("y", "N", -99, 99)


def law(expr: object, *numbers: Constant, name: str = "law", read: Signal = X, written: Signal = Y) -> Block:
    """Return a Block that computes expr(x), with some numbers."""
    return build(
        name,
        TIME,
        lambda u, x, k: Step({written.name: expr(u[read.name])}, numbers=numbers),  # type: ignore[operator]
        inputs=[read],
        outputs=[written],
    )


def text(block: Block) -> str:
    return emit(compose("step", [block], inputs=["x"], outputs=["y"]), F32).files["step.c"]


def test_a_declared_number_has_its_name_unit_and_source() -> None:
    made = text(law(lambda x: 3.45 * x, MASS))
    assert "static const float mass = 3.45f;                            /* kg; Table I */" in made
    assert "mass * x" in made and made.count("3.45") == 1


def test_the_negative_of_a_number_has_its_name() -> None:
    made = text(law(lambda x: ca.fmax(-3.45 * x, x - 3.45), MASS))
    assert "static const float mass = 3.45f;" in made and "-mass * " in made and "- mass" in made


@pytest.mark.parametrize("value", [3.4501, 6.9, 0.0])
def test_another_value_keeps_its_literal(value: float) -> None:
    made = text(law(lambda x: value + 3.0 * x, MASS))
    assert "mass" not in made


def test_a_number_belongs_to_its_block() -> None:
    first = law(lambda x: 3.45 * x, MASS, name="first", written=Signal("z", "m", -9, 9))
    second = law(lambda z: 3.45 + z, name="second", read=Signal("z", "m", -9, 9))
    made = emit(compose("step", [first, second], inputs=["x"], outputs=["y"]), F32).files["step.c"]
    assert "mass * x" in made and "3.45f + " in made


def test_one_name_for_two_values_gets_the_blocks_names() -> None:
    z = Signal("z", "m", -9, 9)
    first = law(lambda x: 3.45 * x, MASS, name="first", written=z)
    second = law(lambda z: 8.6 + z, Constant("mass", 8.6, "kg", "Table II"), name="second", read=z)
    made = emit(compose("step", [first, second], inputs=["x"], outputs=["y"]), F32).files["step.c"]
    assert "first_mass = 3.45f" in made and "second_mass = 8.6f" in made


def test_equal_numbers_are_one_under_the_words_they_share() -> None:
    both = [Constant(f"I_{axis}_over_r", 0.66, "kg m", axis) for axis in "xz"]
    made = text(law(lambda x: 0.66 * x, *both))
    assert "I_over_r = 0.66f;" in made and "kg m; x; z; of x, z */" in made


def test_two_values_with_the_same_common_word_have_names_of_their_own() -> None:
    ends = [Constant(f"highest_y{j}", 0.7 if j < 3 else 0.8, "m", "range", is_limit=True) for j in (1, 2, 3, 4)]
    made = text(law(lambda x: ca.fmin(x, 0.7) + ca.fmin(2 * x, 0.8), *ends))
    assert "highest_y1_y2 = 0.7f;" in made and "highest_y3_y4 = 0.8f;" in made and "/* m; range */" in made


def test_of_equal_numbers_of_two_kinds_the_names_of_a_value_decide() -> None:
    numbers = [
        Constant("largest_step", 0.7, "m", "of a sample", is_limit=True),
        Constant("largest_deviation", 0.7, "1", "reported", is_limit=True),
        Constant("largest_motion", 0.7, "m", "predicted", is_limit=True),
    ]

    def two(u: Mapping[str, ca.SX], x: object, k: object) -> Step:
        deviation = ca.fmin(u["x"] + 1, 0.7)
        motion = ca.fmin(u["x"] ** 2, 0.7)
        other = ca.fmin(u["x"] ** 3, 0.7)
        label(deviation=deviation, motion=motion)
        return Step({"y": (deviation + motion**2) / (other + 5)}, numbers=numbers)

    made = text(build("law", TIME, two, inputs=[X], outputs=[Y]))
    read = re.findall(r"(\w+) = step_min\([^;]*, (largest_\w+)\);", made)
    assert ("motion", "largest_motion") in read and "step_min(x + 1.0f, largest_deviation)" in made
    assert "largest_step) + 5.0f" in made  # the one that is left


def test_equal_numbers_of_two_kinds_that_no_name_decides_say_both() -> None:
    numbers = [Constant("least_a", 0.7, "m", "range"), Constant("least_b", 0.7, "1", "drawing")]
    made = text(law(lambda x: 0.7 + x, *numbers))
    assert "least = 0.7f;" in made and "m or 1; range; drawing; of a, b */" in made


def test_equal_numbers_without_common_words_are_one_under_the_first_name() -> None:
    both = [Constant("first", 0.66, "kg m", "chosen"), Constant("second", -0.66, "kg m", "chosen")]
    made = text(law(lambda x: 0.66 * x, *both))
    assert "first = 0.66f;" in made and "kg m; chosen; also second */" in made


def test_a_factor_of_two_is_part_of_a_formula() -> None:
    two = Constant("acceleration", 2.0, "m/s^2", "chosen")
    assert "acceleration" not in text(law(lambda x: 2 * x, two)) and "acceleration" in text(law(lambda x: 2 + x, two))


def test_a_limit_is_no_factor_and_no_term() -> None:
    half = Constant("largest_step", 0.75, "m", "chosen", is_limit=True)
    made = text(law(lambda x: 0.75 * ca.fmin(x, 0.75) + 0.75, half))
    assert "min(x, largest_step)) + 0.75f" in made and "(0.75f * " in made


def test_a_limit_and_a_factor_of_one_value_keep_their_names() -> None:
    numbers = [Constant("share", 0.75, "1", "chosen"), Constant("largest_step", 0.75, "m", "chosen", is_limit=True)]
    made = text(law(lambda x: 0.75 * ca.fmin(x, 0.75), *numbers))
    assert "share * " in made and "min(x, largest_step)" in made


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_products_of_a_negative_number_are_subtracted(scalar: type[np.floating]) -> None:
    arms = [Constant("arm_x", -0.3, "m", "drawing"), Constant("arm_y", 1.7, "m", "drawing")]

    def expr(x: ca.SX) -> ca.SX:
        return x - 0.3 * x**2 - 1.7 * x**3

    made = [emit(compose("step", [law(expr, *n)], inputs=["x"], outputs=["y"]), scalar) for n in ((), arms)]
    source = made[1].files["step.c"]
    assert "+ (arm_x * " in source and "- (arm_y * " in source and "-arm" not in source
    x = np.random.default_rng(0).uniform(-1, 1, 500).astype(scalar)
    results = [host.load(m.files, m.manifest).replay({"x": x}).outputs["y"] for m in made]
    assert results[0].tobytes() == results[1].tobytes()


def test_the_bound_of_a_sum_of_squares_stays_a_literal_from_which_the_proof_follows() -> None:
    largest = Constant("largest_norm", 0.75, "m^2", "chosen", is_limit=True)

    def inside(x: ca.SX) -> ca.SX:
        u, v = 1.5 * x + 0.3, 0.7 - x
        return ca.if_else(u**2 + v**2 <= 0.75, u - v, 0)

    made = text(law(inside, largest))
    assert "<= 0.75f" in made and "@ admit" in made and "largest_norm" not in made


def test_geometry_needs_no_declaration() -> None:
    assert "half_root_3 * x" in text(law(lambda x: np.sqrt(3) / 2 * x))


def test_counters_compare_with_whole_numbers() -> None:
    left = State(Signal("left", "1", 0, 7), 0, True)
    block = build(
        "count",
        TIME,
        lambda u, x, k: Step(
            {"y": ca.if_else(x["left"] < 3, 3 * u["x"], 0)},
            {"left": ca.if_else(x["left"] < 3, x["left"] + 1, 0)},
            numbers=[Constant("patience", 3.0, "1", "samples")],
        ),
        inputs=[X],
        outputs=[Y],
        states=[left],
    )
    made = text(block)
    assert "< 3u" in made and "patience * x" in made


@pytest.mark.parametrize("scalar", [np.float32, np.float64])
def test_names_change_no_bit(scalar: type[np.floating]) -> None:
    def expr(x: ca.SX) -> ca.SX:
        return ca.if_else(x < 0.25, 3.45 * (x - 0.1), ca.fmin(0.25, x / 3.45) - 0.1 * x**3)

    values = {"mass": 3.45, "low": 0.25, "offset": 0.1, "inverse": 1 / 3.45}
    numbers = [Constant(name, value, "1", "chosen") for name, value in values.items()]
    made = [emit(compose("step", [law(expr, *n)], inputs=["x"], outputs=["y"]), scalar) for n in ((), numbers)]
    assert "offset" in made[1].files["step.c"] and "inverse" in made[1].files["step.c"]
    x = np.random.default_rng(0).uniform(-1, 1, 500).astype(scalar)
    plain, named = (host.load(m.files, m.manifest) for m in made)
    results = [c.replay({"x": x}).outputs["y"] for c in (plain, named)]
    assert results[0].tobytes() == results[1].tobytes()


def test_a_plant_gives_the_numbers_of_its_parameters() -> None:
    plant = build_plant(
        "cart",
        [Signal("v", "m/s", -1, 1)],
        [Signal("f", "N", -1, 1)],
        [Signal("v", "m/s", -1, 1)],
        [Parameter("m", 4.0, "kg", 0.1, "weighed"), Parameter("r", 0.25, "m", 0.1, "drawing")],
        lambda x, u, p: ({"v": u["f"] / p["m"]}, {"v": x["v"]}),
    )
    assert plant.constant("m") == Constant("m", 4.0, "kg", "weighed", parameters=("m",))
    ratio = plant.constant("half_m_over_r", "kg/m", lambda p: p["m"] / (2 * p["r"]))
    assert ratio == Constant("half_m_over_r", 8.0, "kg/m", "m / (2 r), m = 4 kg, r = 0.25 m", parameters=("m", "r"))
