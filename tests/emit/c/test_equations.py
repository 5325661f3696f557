"""Equations in the comments: what they say holds for the composed expressions, and which signals have one."""

import math
import re
from typing import Any

import casadi as ca
import numpy as np
import pytest

from synth.block import Block, Constant, State, Step, build
from synth.composition import compose
from synth.emit.c import equations
from synth.emit.write import emit
from synth.law import label
from synth.signals import Signal
from synth.timing import Discrete
from tests.emit.c.test_manifest import stage

TIME = Discrete(1e-3)
X, Y = Signal("x", "m", -1, 1), Signal("y", "m", -1, 1)


def oscillator() -> Block:
    """Return a Block with a polynomial, a state, a choice, a limit and a number."""

    def law(u: Any, x: Any, k: Any) -> Step:
        angle = 0.345 * (u["x"] - u["y"])
        force = ca.sin(angle) / (2 + u["y"] ** 2) - ca.fabs(x["level"]) * k["gain"]
        limited = ca.fmax(ca.fmin(force, 0.5), -0.5)
        level = ca.if_else(u["x"] < u["y"], x["level"] / 2, -(x["level"] - u["x"]))
        named = [(Signal("angle", "rad", -9, 9), angle), (Signal("force", "N", -9, 9), force)]
        return Step(
            {"out": limited}, {"level": level}, named, numbers=[Constant("stiffness", 0.345, "N/m", "measured")]
        )

    return build(
        "oscillator",
        TIME,
        law,
        inputs=[X, Y],
        outputs=[Signal("out", "N", -1, 1)],
        states=[State(Signal("level", "m", -2, 2), 0.0)],
        constants=[Constant("gain", 0.25, "1", "chosen")],
    )


def shown(block: Block) -> dict[str, str]:
    """Return the right sides of the equations in the comments by left side."""
    text = emit(block, np.float32, error=1e-5).files[f"{block.name}.c"]
    comments = re.findall(r"/\*(.*?)\*/", text, re.DOTALL)
    joined = [re.sub(r"\n\s*\*\s{9,}", " ", comment) for comment in comments]
    rows = [row.strip(" *") for comment in joined for row in comment.splitlines()]
    return dict(row.split(" = ", 1) for row in rows if re.match(r"\w+ = ", row))


def value(text: str, names: dict[str, float]) -> float:
    """Evaluate an equation in Python."""
    text = re.sub(r"\|(\w+)\|", r"abs(\1)", text).replace("^", "**").replace(", else", " else")
    functions = {"limit": lambda x, h: max(min(x, h), -h), "sin": math.sin, "abs": abs}
    return float(eval(text, {"__builtins__": {}}, names | functions))


def violations() -> list[str]:
    """Return the signals whose equations do not hold at random points."""
    block = compose("step", [oscillator()], inputs=["x", "y"], outputs=["out"])
    f, texts, wrong = block.function(), shown(block), set[str]()
    rng = np.random.default_rng(3)
    for x, y, level in rng.uniform(-1, 1, (50, 3)):
        after, out = (float(v) for v in f(level, [x, y]))
        names = {"x": x, "y": y, "level": level, "gain": 0.25, "stiffness": 0.345, "angle": 0.345 * (x - y)}
        names["force"] = math.sin(names["angle"]) / (2 + y**2) - abs(level) * 0.25
        expected = {"out": out, "force": names["force"], "level_next": after}
        wrong |= {n for n, v in expected.items() if n in texts and abs(value(texts[n], names) - v) > 1e-5}
    return sorted(wrong) + ([] if {"force"} <= texts.keys() else ["force is missing"])


def test_the_equations_hold() -> None:
    assert violations() == []


@pytest.mark.parametrize(("operation", "wrong"), [("sub", ("+", 4)), ("mul", ("+", 5)), ("div", ("*", 5))])
def test_a_planted_defect_is_found(operation: str, wrong: tuple[str, int], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(equations.INFIX, operation, wrong)
    assert violations()


def test_an_equation_is_that_of_the_function_and_not_of_its_polynomial() -> None:
    block = compose("step", [oscillator()], inputs=["x", "y"], outputs=["out"])
    assert "sin(angle) / (2 + y^2)" in shown(block)["force"]
    assert "polynomial(" in emit(block, np.float32, error=1e-5).files["step.c"]


def test_guards_need_no_equation_and_a_latch_is_none() -> None:
    text = " ".join(f"{k} = {v}" for k, v in shown(stage()).items())
    assert "complete =" not in text and "if latched" not in text


def test_signals_of_one_form_share_an_equation() -> None:
    def law(u: Any, x: Any, k: Any) -> Step:
        return Step({f"h{j}": ca.sqrt(1 + (u[name] + 0.5) ** 2) for j, name in enumerate(("x", "y"))})

    block = build("pair", TIME, law, inputs=[X, Y], outputs=[Signal(f"h{j}", "m", 0, 9) for j in (0, 1)])
    assert shown(compose("step", [block], inputs=["x", "y"], outputs=["h0", "h1"])) == {
        "h0": "sqrt(1 + (x + 0.5)^2); likewise h1"
    }


def test_no_comment_is_wider_than_120_columns() -> None:
    text = emit(stage(), np.float32, error=1e-5).files["stage.c"]
    assert all(len(row) <= 120 for row in text.splitlines() if row.strip().startswith(("/*", "*")))


def long_law(depth: int = 9) -> Block:
    """Return a Block whose output is too long for an equation unless in its label `drag`."""

    def law(u: Any, x: Any, k: Any) -> Step:
        drag = u["x"]
        for j in range(1, depth + 1):
            drag = (drag + j * u["y"]) * (u["x"] - 0.1 * j)
        label(drag=drag)
        return Step({"out": ca.fmax(ca.fmin(drag * u["y"] + drag, 1), -1)})

    return build("flow", TIME, law, inputs=[X, Y], outputs=[Signal("out", "N", -1, 1)])


def test_a_long_equation_is_in_the_locals_of_the_c() -> None:
    block = compose("step", [long_law()], inputs=["x", "y"], outputs=["out"])
    assert "drag * y + drag" in shown(block)["out"]
    assert "const float drag = " in emit(block, np.float32, error=1e-5).files["step.c"]


def test_a_variable_that_is_no_local_stands_in_no_equation(monkeypatch: pytest.MonkeyPatch) -> None:
    block, by_block = compose("step", [long_law(10)], inputs=["x", "y"], outputs=["out"]), equations.by_block
    monkeypatch.setattr(equations, "by_block", lambda p, variables=(): by_block(p))
    assert "out" not in shown(block)


def test_the_guard_shows_its_latch() -> None:
    assert shown(stage())["left_next"].startswith("latch_samples if complete, else (left if left <= 1")


def tracker(measured: Signal) -> Block:
    """Return a Block whose signals share the variable e of its law."""
    of = measured.name

    def law(u: Any, x: Any, k: Any) -> Step:
        e = u[of] - x["p"]
        now, v = x["p"] + 0.5 * e, x["v"] + 0.125 * e
        label(e=e, now=now, v=v)
        return Step({f"{of}_ahead": now + v + 0.25 * (v * e)}, {"p": now + v, "v": 0.5 * v + 0.0625 * (x["p"] * e)})

    states = [State(Signal(name, "m", -2, 2), 0.0) for name in ("p", "v")]
    outputs = [Signal(f"{of}_ahead", "m", -9, 9)]
    return build(f"tracker_{of}", TIME, law, inputs=[measured], outputs=outputs, states=states)


def test_equations_are_in_the_variables_that_they_share() -> None:
    """Both Blocks have an e, so that its name alone does not say which one is meant: the section does."""
    shown_rows = shown(compose("step", [tracker(X), tracker(Y)], inputs=["x", "y"], outputs=["x_ahead", "y_ahead"]))
    x, p, v = 0.3, -0.2, 0.7
    e = x - p
    now, rate = p + 0.5 * e, v + 0.125 * e
    names = {"x": x, "p": p, "v": v, "e": e, "tracker_x_p": p, "tracker_x_v": v}
    rows = {n: text for n, text in shown_rows.items() if re.search(r"\be\b", text) or n == "e"}
    assert rows["e"] == "x - p" and not any("x - p" in text for n, text in rows.items() if n != "e")
    right = {
        "e": e,
        "now": now,
        "v": rate,
        "x_ahead": now + rate + 0.25 * rate * e,
        "p_next": now + rate,
        "v_next": 0.5 * rate + 0.0625 * p * e,
    }
    assert {n: value(text, names) for n, text in rows.items()} == pytest.approx({n: right[n] for n in rows})


@pytest.mark.parametrize(
    ("text", "other", "alike"),
    [
        ("limit(force_x, high)", "limit(force_y, high)", True),
        ("now if ready, else x", "prediction_p if ready, else x", False),
        ("decay * integral + part * u", "lead_input * error + pole * lead", False),
        ("p + k_p * e", "h + k_h * e", True),
    ],
)
def test_equations_stand_together_where_their_names_correspond(text: str, other: str, alike: bool) -> None:
    first, second = (equations.Equation(f"a_{t[0]}", 0, t, True) for t in (text, other))
    assert first.form == second.form
    assert len(equations._together([first, second])) == (1 if alike else 2)


def test_a_name_on_the_left_corresponds_as_those_on_the_right_do() -> None:
    now, a, y = (equations.Equation(*each, True) for each in (
        ("now", 0, "p + k_p * e"), ("a", 1, "h + k_h * e"), ("h", 2, "h + k_h * e")))  # fmt: skip
    p = equations.Equation("p", 0, "p + k_p * e", True)
    assert len(equations._together([now, a])) == 2
    assert equations._together([p, y]) == ["p = p + k_p * e; likewise h"]
