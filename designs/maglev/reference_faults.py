"""Fault handling of the maglev controller: NumPy reference for the generated C, around the law of `reference`.

    readings     y1 - y2 + y3 - y4 = 0 by F(5); x and z stand alone
    handover     direct currents of the motors along x or z, whose position is lost, as in `reference_phase`

Redundancy, predictions, probe and landing are those of `synth.reference`, with the numbers below.
`step` is that of the shipped controller, columns (n,) by name as in `reference`.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from designs.maglev import reference_phase, reference_stage
from designs.maglev.reference_stage import AXES, HIGH, LAST, LIMITS, LOW, NAMES, SENSORS
from synth.reference import fault_handling, guard
from synth.reference.guard import rows

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Columns = Mapping[str, NDArray[Any]]
# Of the demands, gaps and last currents: the currents (6, n), accelerations of x and z by them (2, n), and next states.
Finish = Callable[[Array, Array, Array], tuple[Array, Array, dict[str, Any]]]
# Of the states, the pose (5, n), the set-points (5, n) and whether it is ready: the demands (5, n) and what follows.
Law = Callable[[Columns, Array, Array, Flags], tuple[Array, Finish]]

T = 1e-3  # s
K = 6.109410204869  # normal noise exceeds so many standard deviations in 1e-9 of the samples
OFFSET, QUIET = 4 * 7e-6, 4 * (5e-6 + 7e-6)  # m: of four gap encoders, with half a count of each
NOISE = 2 * np.sqrt(1e-10 + 1e-10 / 12)  # m: one count of each, rounded to counts
SLOPE = (
    K * QUIET / np.sqrt(QUIET**2 - OFFSET**2)
)  # of a hyperbola over the noise that the line OFFSET + K NOISE touches
SENSING = fault_handling.Sensors(
    dict(zip(NAMES[:4], (1.0, -1.0, 1.0, -1.0), strict=True)),
    QUIET,
    SLOPE**2 / 2,
    np.hypot(QUIET, SLOPE * NOISE),
    "xz",
    gate=40e-6,  # m
    frozen=82e-6,  # m: the noise of four codes cancels such a motion in 1e-9 of the samples
    jump=0.15e-3,  # m: 40 um, 66 um at the rate and 27 um by an acceleration of 53 m/s^2, and a count of 10 um
    wide_jump=0.5e-3,  # m
    wide_frozen=0.2e-3,  # m
    travel=0.0499,  # m
    longest=40,
    low=LOW[:SENSORS],
    high=HIGH[:SENSORS],
)
OBSERVERS = fault_handling.Observers(  # in m, rad and s
    {
        "y": fault_handling.Axis(120.0, 0.0145, 0.0345, 4.0, 50.0),
        "x": fault_handling.Axis(60.0, -0.1, 0.1, 2.0, 20.0, True),
        "z": fault_handling.Axis(60.0, -0.1, 0.1, 2.0, 20.0, True),
        "phi": fault_handling.Axis(120.0, -0.02, 0.02, 4.0, 200.0),
        "theta": fault_handling.Axis(120.0, -0.031, 0.031, 4.0, 200.0),
    },
    T,
    learning=30.0,
    gains=(0.8, 1.2),
)
POLES = dict(zip(AXES, (60.0, 30.0, 30.0, 0.0, 40.0), strict=True))  # rad/s; phi is left to its spring
LANDING = fault_handling.Landing(
    POLES,
    POLES | {"theta": 14.0},  # it is predicted
    end=0.031,  # m
    beyond=0.4e-3,
    speed=0.08,
    touch=5e-3,
    press=1e-3,
    descent=2.0,
    braking=(4.0, 4.0),
    bad_samples=reference_stage.BAD_SAMPLES,
    good_samples=reference_stage.GOOD_SAMPLES,
    T=T,
)
PROBE = fault_handling.Probe(quiet=40, quarter=3, step=4.2e-6, attempts=5, T=T)
LIFTED, LOST = 0.0305, 0.2  # m
HELD_BY_SPRING = 0.022  # m: below, theta needs the motors along X
PHI_SPRING = 0.75 * 15_000.0  # 1/s^2, the compensated part
DELAYED = 1e6  # m/s^2, rad/s^2: bound of the accelerations of one sample ago
DEMANDS = {"y": "w_y", "x": "a_x", "z": "a_z", "phi": "w_phi", "theta": "w_theta"}
MISSED_CALLS = 40


def expected_readings(q: Array) -> Array:
    """Return the readings (6, n) at a predicted pose, F(5) for small angles."""
    r = reference_stage.Parameters().r
    return np.array([q[0] - r * q[3], q[0] + r * q[4], q[0] + r * q[3], q[0] - r * q[4], q[1], q[2]])


def land(
    state: Columns, w: Array, estimate: tuple[Array, Array, Array], phi: Array, regular: Flags, determined: Flags
) -> tuple[Array, dict[str, Any]]:
    """Return the demands (5, n), the tracking ones w or those of the landing, and the next states with `landed`."""
    demand, lands, next = fault_handling.demand(state, estimate, regular, determined, LANDING)
    demand[3] = -PHI_SPRING * phi
    return np.where(lands, np.clip(demand, -LANDING.most, LANDING.most), w), next


def without_positions(state: Columns, computed: Array, trusted: Flags) -> tuple[Array, Array]:
    """Return the next transfer and the currents (6, n), as the commutation hands over direct currents."""
    i_d, (u_x, u_z), lost = computed[:4], computed[4:], ~trusted
    before = np.asarray(state["handover_transfer"], dtype=np.float64)
    active = lost.any(axis=0) | (before != 0)
    stays = lost[0] & (lost[1] | (state["observer_y_q"] < HELD_BY_SPRING))
    transfer = reference_phase.next_transfer(before, lost[0], lost[1], stays)
    values = {f"i_d{j}": i for j, i in enumerate(i_d, 1)} | {"i_q1": u_z, "i_q2": u_x, "i_q3": u_z, "i_q4": u_x}
    direct = reference_phase.direct_currents(values, transfer, active)
    part = {"x": np.maximum(transfer, 0), "z": np.maximum(-transfer, 0)}
    kept = [np.where(active, (1 - part["zxzx"[j - 1]]) * direct[j], i) for j, i in enumerate(i_d, 1)]
    return np.where(active, transfer, 0), np.concatenate([kept, computed[4:]])


def step(
    state: Columns, inputs: Columns, law: Law, at_rest: fault_handling.Probe = PROBE
) -> tuple[dict[str, Array], dict[str, Array], NDArray[Any]]:
    """Return (next state, outputs, fault word) of one sample of a law with its fault handling, columns by name."""
    accepted = guard.accept(state, inputs, LIMITS)
    values, good = np.array([*accepted.values.values()]), np.array([accepted.good[n] for n in NAMES])
    ready = np.asarray(state["guard_ready"]) > 0
    expected = expected_readings(fault_handling.positions(state, AXES))
    used, suspects, flag, after_readings = fault_handling.readings(
        state, values[:SENSORS], good, expected, at_rest.attempts, inputs["missed_calls"], SENSING
    )
    pose = reference_stage.pose(used, reference_stage.Parameters().r)
    still = np.array([after_readings[f"{s}_monitor_still"] for s in "xz"])
    acting = rows(state, [f"delay_{DEMANDS[s]}_last" for s in AXES])
    q, v, d, after_observers = fault_handling.observe(
        state, pose, acting, flag["trusted"], flag["frozen"], still, ready, OBSERVERS
    )
    last, set_points = rows(state, LAST), values[SENSORS:]
    e = pose - set_points
    w, finish = law(state, pose, set_points, ready)
    w, after_landing = land(state, w, (q, v, d), pose[3], flag["regular"], flag["determined"])
    free = flag["regular"] & (state["observer_y_q"] < LIFTED)
    w[1:3], after_probe = fault_handling.probe("xz", w[1:3], e[1:3], state, still, free, at_rest)
    computed, thrust, after_law = finish(w, used[:4], last)
    transfer, computed = without_positions(state, computed, flag["trusted"])
    complete = good.all(axis=0)
    enough = np.where(ready, flag["sufficient"] & flag["trusted"].any(axis=0), complete)
    after = accepted.after | guard.count(state, enough, reference_stage.BAD_SAMPLES, reference_stage.GOOD_SAMPLES)
    landed = after_landing.pop("landed")
    latched = (after["guard_latched"] > 0) | landed
    after |= {"guard_latched": latched, "guard_ready": np.where(complete, 1, state["guard_ready"])}
    demands = {"w_y": w[0], "a_x": thrust[0], "a_z": thrust[1], "w_phi": w[3], "w_theta": w[4]}
    next: dict[str, Any] = after_readings | after_observers | after_landing | after_probe | after_law
    next |= {f"delay_{n}_last": np.clip(x, -DELAYED, DELAYED) for n, x in demands.items()}
    next["handover_transfer"] = transfer
    outputs, slewed = reference_stage.safe_outputs(state, computed, latched, landed & (pose[0] >= LIFTED))
    word = (
        accepted.word
        | (1 << np.arange(11, 17)) @ suspects
        | (flag["degraded"].astype(np.uint32) << 17)
        | (fault_handling.misses_calls(inputs["missed_calls"], MISSED_CALLS).astype(np.uint32) << 18)
        | ((next["landing_landing"] & ~latched).astype(np.uint32) << 30)
    )
    positions = np.where(latched & ~flag["trusted"], LOST, used[4:])
    outputs |= {"x_commutation": positions[0], "z_commutation": positions[1]}
    return after | guard.frozen(state, next, latched) | slewed, outputs, guard.fault_word(word, after)
