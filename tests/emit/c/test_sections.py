"""Each line of a step stands in the section of the Block that computes it."""

import json
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import casadi as ca

from designs.maglev_5dof.design import DESIGN
from synth.block import Block, State, Step, build
from synth.composition import compose
from synth.emit.write import emit
from tests.emit.dyadic import TIME, signal
from tests.emit.passes.test_guards import F32

GENERATED = Path(__file__).parents[3] / "generated_c"
LOCAL = re.compile(r"^ +const (?:float|bool|uint32_t) (\w+) = ")


def wrong_places(block: Block, text: str, trace: Mapping[str, list[list[int]]]) -> list[str]:
    """Return the signals whose local stands in the section of another Block than the ones that compute its value."""
    tags = {n: tag.split(":")[0] for tag, runs in trace.items() for a, b in runs for n in range(a, b + 1)}
    owners: dict[str, set[str]] = {}
    for named, expr in block.computed_signals:
        same = {other.block for other, e in block.computed_signals if ca.is_equal(e, expr, 1)}
        owners.setdefault(named.signal.name, set()).update(same)
    names = {n: match[1] for n, line in enumerate(text.splitlines(), 1) if (match := LOCAL.match(line)) and n in tags}
    return [name for n, name in names.items() if name in owners and tags[n] not in owners[name]]


def latch_of_an_angle() -> Block:
    """Return a first Block whose flag depends on values that two Blocks behind it compute."""
    t, v, f, s = (signal(name, -size, size) for name, size in (("t", 1e7), ("v", 1e8), ("f", 1e8), ("s", 1e7)))

    def rate_law(u: Any, x: Any, k: Any) -> Step:
        return Step({"v": (u["t"] - x["s"]) * 8}, {"s": u["t"]})

    def flag_law(u: Any, x: Any, k: Any) -> Step:
        return Step({"f": ca.if_else(u["v"] > 1, u["t"], u["v"])})

    ends = [signal("a"), signal("b")]
    angle = build("pose", TIME, lambda u, x, k: Step({"t": u["a"] - u["b"]}), inputs=ends, outputs=[t])
    rate = build("rate", TIME, rate_law, inputs=[t], outputs=[v], states=[State(s, 0)])
    flag = build("flag", TIME, flag_law, inputs=[v, t], outputs=[f])
    return compose("stage", [flag, angle, rate], inputs=["a", "b"], outputs=["f"])


def test_values_for_a_later_signal_stand_in_their_own_sections() -> None:
    block = latch_of_an_angle()
    made = emit(block, F32)
    trace = made.manifest["trace"]
    assert not wrong_places(block, made.files["stage.c"], trace)
    moved = dict(zip(trace, [*list(trace.values())[1:], next(iter(trace.values()))], strict=True))
    assert wrong_places(block, made.files["stage.c"], moved)


def test_each_signal_of_the_maglev_controller_stands_in_its_section() -> None:
    folder = GENERATED / DESIGN.name
    text = (folder / f"{DESIGN.name}.c").read_text()
    trace = json.loads((folder / "manifest.json").read_text())["trace"]
    assert DESIGN is not None
    assert not wrong_places(DESIGN.controller.block, text, trace)
    guard = next(tag for tag in trace if tag.startswith("guard:"))
    kinematics = next(tag for tag in trace if tag.startswith("kinematics:"))
    planted = {**trace, guard: [*trace[guard], *trace[kinematics]], kinematics: []}
    assert "y" in wrong_places(DESIGN.controller.block, text, planted)
