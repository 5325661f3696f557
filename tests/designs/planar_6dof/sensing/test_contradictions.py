"""Hall voltages that contradict each other: never by noise, named at once where one fails, and what nobody notices.

plant's voltages + noise + fault ---> [ guard, sensing, filters ] ---> fault word, suspects
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from designs.planar_6dof import filtering
from designs.planar_6dof.sensing import contradictions
from designs.planar_6dof.sensing import maps as sensing_maps
from designs.planar_6dof.sensing import sections as sensing
from synth.block import Block, unranged
from synth.blocks.guard import safety
from synth.composition import compose
from synth.emit import write
from synth.execute import host
from synth.statespace import Array
from tests.designs.planar_6dof.measured import (
    AS_MEASURED,
    HALL,
    PLANT,
    RESIDUALS,
    TIME,
    A,
    L,
    estimation,
    motion,
    noisy,
    reference_step,
    replay,
    rms,
    start,
)

pytestmark = pytest.mark.whole

BOUNDS = {
    name: (contradictions.EXCESS_BOUND * A if name.startswith("m_") else contradictions.RESIDUAL_BOUND) * A
    for name in RESIDUALS
}


def rho(out: Mapping[str, Array]) -> Array:
    """Return the residual over its bound."""
    return np.sqrt(np.sum([(out[name] / bound) ** 2 for name, bound in BOUNDS.items()], axis=0))


@pytest.mark.parametrize("predicted", [True, False])
def test_nothing_is_suspected_in_1e5_noisy_samples(predicted: bool) -> None:
    n = 120_000
    t = np.arange(n) * TIME.period_s
    pose = {"x": 0.1 * np.sin(0.7 * t), "y": 0.09 * np.sin(1.1 * t), "phi": 6e-3 * np.sin(7 * t)}
    pose |= {"z": 2e-4 * np.sin(3 * t), "theta": 1e-3 * np.sin(2 * t), "psi": 1e-3 * np.sin(5 * t)}
    run = replay(pose, noise=True, scalar=np.float32, predicted=predicted)
    assert not any(run[s.name].any() for s in (sensing.SUSPECTED, *sensing.SUSPECTS))
    assert all(np.abs(run[name]).max() > 0.3 * bound for name, bound in BOUNDS.items()) and rho(run).max() < 1.0
    assert rms(run["phi" if predicted else "phi_raw"] - pose["phi"]) < (2e-3 if predicted else 4e-3)


@dataclass(frozen=True)
class Outcome:
    """Of runs in which one sensor fails: shares noticed and named among, and samples to the name, at most and mostly.

    `delay` is from the contradiction that confirms to the suspects' bits in the fault word, `late` from the first one.
    """

    noticed: float
    among: float
    delay: int
    late: int


def outcomes(columns: int, predicted: bool) -> dict[tuple[str, bool], Outcome]:
    """Fail each voltage, stuck or at zero, at sample 150 of noisy motions."""
    n, at, kinds = 600, 150, [(name, stuck) for name in HALL for stuck in (False, True)]
    pose = motion(n, columns, 3)
    clean = {k: np.tile(v.reshape(n, columns), len(kinds)) for k, v in sensing_maps.voltages(PLANT, pose).items()}
    u, which = noisy(clean, 4), np.repeat(np.arange(len(kinds)), columns)
    for j, (name, stuck) in enumerate(kinds):
        u[name][at:, which == j] = u[name][at, which == j] if stuck else 0.0
    state, named, word_named, over = start(predicted, len(which)), [], [], []
    for i in range(n):
        flags = np.full(len(which), float(i > 0)), ~(state["sensing_contradiction_confirmed"] > 0)  # the guard's
        out, state = reference_step(state, {k: v[i] for k, v in u.items()}, flags, predicted)
        word_named.append(out["suspected"] > 0)
        named.append([out[f"suspect_{v}"] > 0 for v in HALL])
        over.append(rho(out) * (i > 0))
    flagged, bits, size = np.array(named), np.array(word_named), np.array(over)  # (n, 6, N), (n, N), (n, N)
    assert not bits[:at].any()
    assert flagged.any(axis=1)[bits].all()  # never nobody
    first, started, second = (np.full(len(which), n) for _ in range(3))
    for j in range(len(which)):
        for sample in np.flatnonzero(size[:, j] > 1):
            again = np.flatnonzero(size[sample + 1 : sample + 1 + sensing.MEMORY, j] > sensing.CONFIRMATION)
            if again.size:
                started[j], second[j] = sample, sample + 1 + again[0]
                break
        first[j] = bits[:, j].argmax() if bits[:, j].any() else n
    seen, last = first < n, np.minimum(first, n - 1)
    assert (seen == (second < n - 1)).all()
    result = {}
    for j, (name, stuck) in enumerate(kinds):
        mine = seen & (which == j)
        itself = flagged[last[mine], HALL.index(name), np.flatnonzero(mine)]
        result[name, stuck] = Outcome(
            float(mine[which == j].mean()),
            float(itself.mean()) if mine.any() else 0.0,
            int((first - second)[mine].max(initial=0)),
            int((first - started)[mine].max(initial=0)),
        )
    return result


@pytest.mark.parametrize("predicted", [True, False])
def test_a_sensor_that_fails_in_motion_is_named_at_once(predicted: bool) -> None:
    """Two contradictions and the sample in which the word tells it, 5 after the first at most."""
    for outcome in outcomes(80, predicted).values():
        assert outcome.noticed > 0.95 and outcome.among > 0.95
        assert outcome.delay == 1 and outcome.late <= sensing.MEMORY + 1


def guarded(predicted: bool) -> Block:
    held = [replace(s, name=s.name.removesuffix("_held")) for s in sensing.HELD]
    inputs = [safety.GuardedInput(s, 0.0, True, held=False) for s in held]
    parts = [safety.guard(TIME, inputs, WAIT, HALL), sensing.sensing(PLANT, TIME, predicted)]
    parts += filtering.blocks(TIME) if predicted else []
    return compose("guarded", parts, inputs=HALL, outputs=["x", "y", "phi"] if predicted else AS_MEASURED)


WAIT = 5  # samples that are not complete, of which the last latches


@cache
def guarded_c(predicted: bool) -> host.Controller:
    made = write.emit(unranged(guarded(predicted)), np.float32)
    return host.load(made.files, made.manifest)


@cache
def bits() -> tuple[dict[str, int], dict[str, int]]:
    """Return the masks of the fault word that say a voltage is out of range, and that it is a suspect."""
    faults = guarded(True).faults
    refused = {f.input: 1 << f.bit for f in faults if f.input}
    suspect = {f.suspect: 1 << f.bit for f in faults if f.suspect}
    assert set(refused) == set(suspect) == set(HALL) and len({*refused.values(), *suspect.values()}) == 2 * len(HALL)
    return refused, suspect


def resting(n: int) -> dict[str, Array]:
    return noisy(sensing_maps.voltages(PLANT, {"x": np.full(n, L / 16), "y": np.full(n, L / 16)}))


@pytest.mark.parametrize("predicted", [True, False])
@pytest.mark.parametrize("name", HALL)
@pytest.mark.parametrize("value", [0.0, np.nan, 7.0])
def test_what_contradicts_is_named_and_latches(name: str, value: float, predicted: bool) -> None:
    n, at, (refused, suspect) = 80, 50, bits()
    u = resting(n)
    u[name][at:] = value
    run = guarded_c(predicted).replay(u)
    bit = suspect[name] if value == 0 else refused[name]
    wait = 2 if value == 0 else 0  # two samples contradict before it is named
    latch = at + wait + WAIT - 1
    assert (run.faults[: at + wait] == 0).all() and wait <= 5
    assert (run.faults[at + wait :] & bit).all()
    assert not (run.faults & (1 << safety.LATCH_BIT))[:latch].any() and (run.faults >> safety.LATCH_BIT)[latch:].all()
    if value != 0:  # nothing else is said
        assert (run.faults[at:latch] == bit).all()
    for axis in "xy":  # and meanwhile the position stays
        position = run.outputs[axis if predicted else f"{axis}_raw"]
        assert abs(position[at : latch + 1] - L / 16).max() < 2.5e-4


@pytest.mark.parametrize("predicted", [True, False])
@pytest.mark.parametrize("every", [1, 2, 4])
def test_a_loose_contact_is_named(every: int, predicted: bool) -> None:
    """One that is open in each second or fourth sample only; in each fifth it is no more than a single glitch."""
    n, at, (_, suspect) = 120, 50, bits()
    for name in HALL:
        u = resting(n)
        u[name][at::every] = 0.0
        faults = guarded_c(predicted).replay(u).faults
        latest = at + every + 1
        assert not faults[:latest].any() and (faults[latest : latest + WAIT] & suspect[name]).all()
        assert faults[latest + WAIT - 1] >> safety.LATCH_BIT
    u = resting(n)
    u["V_ax"][at :: sensing.MEMORY + 1] = 0.0
    assert not guarded_c(predicted).replay(u).faults.any()


@pytest.mark.parametrize("predicted", [True, False])
def test_a_single_glitch_is_passed_over(predicted: bool) -> None:
    u = resting(100)
    calm = guarded_c(predicted).replay({k: v.copy() for k, v in u.items()})
    for name in HALL:
        glitch = {k: v.copy() for k, v in u.items()}
        glitch[name][60] = 4.9
        run = guarded_c(predicted).replay(glitch)
        assert (run.faults == 0).all()
        apart = [np.abs(run.outputs[a] - calm.outputs[a]) for a in (("x", "y") if predicted else ("x_raw", "y_raw"))]
        # Without a filter the sample is that before; a yaw that is another one fades.
        assert max(v.max() for v in apart) < (5e-5 if predicted else 3e-4) and max(v[80:].max() for v in apart) < 2e-5


@pytest.mark.parametrize("predicted", [True, False])
def test_the_map_of_faults_says_what_is_not_noticed(predicted: bool) -> None:
    filters = filtering.blocks(TIME) if predicted else ()
    zero, stuck = (f(PLANT, TIME, 5, filters) for f in (sensing_maps.zero_voltages, sensing_maps.stuck_voltages))
    first, second = ({name: w.summary(name) for name, w in of.items()} for of in (zero, stuck))
    assert [*first] == [*second] == [*HALL] and all(r["named, %"] == 100 for r in (*first.values(), *second.values()))
    # What drops to zero near its zero is not noticed, and is worth little; V_bx and V_cy hide wherever the circle of
    # their pair passes near by.
    assert 30 < first["V_bx"]["unnoticed, %"] < 60 and first["V_bx"]["position, mm"] < 5
    assert all(first[v]["unnoticed, %"] <= 20 for v in ("V_ax", "V_ay", "V_by", "V_cx"))
    assert all(r["unnoticed, %"] == 0.0 and r["moved, mm"] < 15 for r in second.values())


def test_at_rest_a_sensor_that_sticks_is_not_noticed() -> None:
    start = np.full((2, 1), L / 16)
    for predicted in (True, False):
        seen = sensing_maps.watch(PLANT, estimation(predicted), start, 0 * start, 50, "V_ax", sticks=True)
        assert seen.noticed.tolist() == [-1] and seen.error.max() < 1e-5
