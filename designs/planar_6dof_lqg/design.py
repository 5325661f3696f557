"""The planar positioner of Yu and Kim under its reduced-order LQG controller at 800 Hz, from physics to verified C."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cache, partial
from typing import Any

from designs.planar_6dof import artefacts, assembly, lqg, vertical
from designs.planar_6dof.allocation import HORIZONTAL
from designs.planar_6dof.interface import Subject
from designs.planar_6dof_lqg import reference
from models import planar_stage
from synth import stage
from synth.block import Block
from synth.statespace import Array
from synth.synthesise import digits


def at_rest(block: Block, pose: Mapping[str, Array]) -> dict[str, Array]:
    """Return x3 (N,) of platens at rest, -L times the position: up to 50 times what the motors can meet."""
    L = {c.name: c.value for c in block.constants}
    return {f"lqg_{axis}_x3": -L[f"lqg_{axis}_L"] * pose[axis] for axis in HORIZONTAL}


@cache
def subject() -> Subject:
    """Return the controller beside its reference."""
    block = lqg.controller(planar_stage.plant())
    return Subject(block, reference.step, size=0.1, step=0.06, at_rest=partial(at_rest, block))


def gains() -> dict[str, Any]:
    """Return (49) with its weights, plant, rate and certificate, the observers, and the vertical compensators.

    The gain of the weights that are printed with (49) is listed beside it.
    """
    plant = planar_stage.plant()
    gain, of_printed_weights = lqg.gain(), lqg.gain(lqg.PRINTED_WEIGHTS)
    return {
        "plant": "(31) as printed: q'' = B i in x, y and phi, with their rates d, f, v and their integrals z1, z2, z3",
        "period_s": lqg.TIME.period_s,
        "method": "lqrd: the integral of x'Q x + u'u with u held over a period, u = K x",
        "states": list(lqg.STATES),
        "weights_Q": list(lqg.WEIGHTS),
        "weight_R": 1.0,
        "K": _rows(gain.K),
        "poles": [digits.pole(z) for z in gain.poles],
        "certificate": digits.certificate(gain.certificate),
        "printed_weights": {
            "weights_Q": list(lqg.PRINTED_WEIGHTS),
            "K": {name: [digits.significant(v, 6) for v in row] for name, row in _rows(of_printed_weights.K).items()},
            "certificate": digits.certificate(of_printed_weights.certificate),
        },
        "axes": {axis.name: _axis(axis) for axis in lqg.axes(plant)},
        "compensators": artefacts.compensators(vertical.loops(lqg.TIME)),
    }


def _rows(K: Array) -> dict[str, list[float]]:
    return {name: [float(v) + 0.0 for v in row] for name, row in zip(lqg.CURRENTS, K, strict=True)}


def _axis(axis: lqg.Axis) -> dict[str, Any]:
    """Return the gains of an axis on position, rate and the sum of errors, and its observer of the rate."""
    observer = lqg.observer(axis)
    numbers = {"F": observer.F, "G": observer.G, "H": observer.H, "L": observer.L}
    return {
        "b": digits.significant(axis.b, 12),
        "gains": {name: digits.significant(getattr(axis, name), 12) for name in ("k1", "k2", "k3")},
        "observer": {
            "pole": lqg.OBSERVER_POLE[axis.name],
            "poles": [digits.pole(z) for z in observer.poles],
            **{name: digits.significant(float(m[0, 0]), 12) for name, m in numbers.items()},
        },
    }


def runs() -> Sequence[Any]:
    """Return the experiments; they are imported here, since an import of the design simulates nothing."""
    from designs.planar_6dof_lqg import experiments

    return experiments.ALL


def contents(of: stage.Stage, results: Any) -> Any:
    """Return what the report has beyond the standard sections; `synth emit` does without what draws it."""
    from designs.planar_6dof_lqg import page

    return page.contents(of, results)


def audit_rows(shipped: Any) -> Iterator[Any]:
    """Yield the rows of the audit for the shipped loop, a `Rig`."""

    from designs.planar_6dof.paper import rows

    return rows.lqg(shipped)


REQUIRE = {  # degrees and s; a little below the least in the middle and over a pitch
    "phase_margin": 30.0,
    "gain_margin": 2.7,
    "gain_reduction": 2.8,
    "delay_margin": 1.7e-3,
    "modulus_margin": 0.47,
    "disk_margin": 0.24,
}
DESIGN = assembly.design(
    lqg.NAME, lqg.TIME, subject, gains, runs, audit_rows, contents, ["step_x_large"], require=REQUIRE
)
