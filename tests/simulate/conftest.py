"""Small plants and a hand-written controller that keeps the contract of emitted C."""

from collections.abc import Callable, Mapping

import casadi as ca
import pytest

from synth import plant
from synth.execute import host
from synth.signals import Parameter, Signal

T = 1e-3
LEVEL_C = """#include "level.h"
#define KP (real)400
#define KD (real)6
#define BIAS (real)2
#define PERIOD (real)0.001
void level_init(level_state_t *state) { state->last = (real)0.02; state->ticks = 0u; }
uint32_t level_step(level_state_t *state, const level_input_t *in, level_output_t *out) {
    const int good = in->gap >= (real)0.001 && in->gap <= (real)0.1;
    const real gap = good ? in->gap : state->last;
    out->current = BIAS + KP * (gap - in->gap_ref) + KD * ((gap - state->last) / PERIOD);
    out->overflow = (real)1 / (gap - gap);
    out->trim = (real)100 * in->gap_ref;
    state->last = gap;
    state->ticks = state->ticks + 1u;
    return good ? 0u : 1u;
}
"""
LEVEL_H = """#include <stdint.h>
typedef REAL real;
typedef struct { real gap, gap_ref; } level_input_t;
typedef struct { real current, overflow, trim; } level_output_t;
typedef struct { real last; uint32_t ticks; PAD } level_state_t;
void level_init(level_state_t *state);
uint32_t level_step(level_state_t *state, const level_input_t *in, level_output_t *out);
"""


def field(name: str, offset: int, ctype: str, unit: str = "1") -> dict[str, object]:
    return {"name": name, "offset": offset, "count": 1, "ctype": ctype, "unit": unit, "low": -1.0, "high": 1.0}


def level_manifest(scalar: str) -> dict[str, object]:
    size, real = (4, "float") if scalar == "float32" else (8, "double")
    fields = {
        "input": [field("gap", 0, real, "m"), field("gap_ref", size, real, "m")],
        "output": [
            field("current", 0, real, "A"),
            field("overflow", size, real, "A"),
            field("trim", 2 * size, real, "A"),
        ],
        "state": [field("last", 0, real, "m"), field("ticks", size, "uint32_t")],
    }
    sizes = {"input": 2 * size, "output": 3 * size, "state": 2 * size}
    structs = {role: {"type": f"level_{role}_t", "size": sizes[role], "fields": f} for role, f in fields.items()}
    functions = {"init": "level_init", "step": "level_step"}
    return {"design": "level", "period_s": T, "scalar": scalar, "functions": functions, "structs": structs}


@pytest.fixture(scope="session")
def level() -> Callable[[str], host.Controller]:
    """A proportional and derivative regulator of a gap, with a range check of the gap."""

    def load(scalar: str) -> host.Controller:
        real, pad = ("float", "") if scalar == "float32" else ("double", "uint32_t reserved;")
        header = LEVEL_H.replace("REAL", real).replace("PAD", pad)
        return host.load({"level.h": header, "level.c": LEVEL_C}, level_manifest(scalar))

    return load


def _build(
    name: str, force: Callable[[Mapping[str, ca.SX], Mapping[str, ca.SX], Mapping[str, ca.SX]], ca.SX]
) -> plant.Plant:
    """A mass with the gap q and the speed v, beside a carriage s that the current pushes too."""
    states = [Signal("q", "m", 0.001, 0.1), Signal("v", "m/s", -10, 10)]
    states += [Signal("s", "m", -1, 1), Signal("w", "m/s", -10, 10)]
    inputs = [Signal("i", "A", -50, 50), Signal("j", "A", -50, 50)]
    parameters = [
        Parameter("m", 2.0, "kg", 0.0, "test"),
        Parameter("c", 0.002, "kg m^3/s^2/A^2", 0.0, "test"),
        Parameter("G", 9.81, "m/s^2", 0.0, "test"),
    ]
    return plant.build(
        name,
        states,
        inputs,
        [Signal("gap", "m", 0.001, 0.1), Signal("lift", "kg m/s^2", -1e3, 1e3)],
        parameters,
        lambda x, u, p: (
            {"q": x["v"], "v": force(x, u, p) / p["m"], "s": x["w"], "w": u["j"] / p["m"]},
            {"gap": x["q"], "lift": force(x, u, p)},
        ),
    )


@pytest.fixture(scope="session")
def magnet() -> plant.Plant:
    """An unstable magnet: m dv/dt = m G - c (i/q)^2, with q falling open."""
    return _build("magnet", lambda x, u, p: p["m"] * p["G"] - p["c"] * (u["i"] / x["q"]) ** 2)


@pytest.fixture(scope="session")
def mass() -> plant.Plant:
    """A free mass: m dv/dt = -i, in newtons for each ampere."""
    return _build("mass", lambda x, u, p: -u["i"])
