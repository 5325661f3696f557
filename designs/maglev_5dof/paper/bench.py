"""The loops under audit, made once for a plant: ideal ones and compiled ones on encoders.

"Ideal" is the loop in continuous time with ideal sensing (`continuous`). "Encoders" is the compiled controller at
1 kHz on encoders of 10 um with its filters and one sample of delay: with the printed law (12), or `restored`, with the
shipped law, which puts back the squares of i_d that (11) drops and cancels the guide springs in part. Both laws take
squares of currents one sample late, and each motor at its own measured gap. Tracking errors are means of |e|, with
encoders from 10 to 60 s. Ideal runs are periodic by 12 s, and the mean is over the six whole periods up to 20 s.
Shorter runs keep these proportions.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Literal

import numpy as np

from designs.maglev_5dof import control, experiments
from designs.maglev_5dof.paper import continuous
from models import maglev_stage
from synth.declaration import Stage
from synth.execute import build, host
from synth.plant import Plant
from synth.simulate.conditions import Sine
from synth.simulate.rig import Rig

Springs = Literal["known", "unknown", "absent"]

MAGNETS = ("b0", "t1", "h_m", "L_A", "p_m", "tau", "tau_p", "H_c", "mu_rec", "mu0")
FORCES = (*MAGNETS, "W", "w_c", "p", "z1")
FIELD = (*(name for name in MAGNETS if name != "mu0"), "W", "p")
MM = 1e-3
SPRINGS = ("k_s_phi", "k_s_theta")
FRICTION = {"x": 1.8, "z": 1.3}  # N of guide friction, fitted to the two printed errors of the ellipse
KEPT = 32  # runs that the rows share


@dataclass(frozen=True, eq=False)
class Bench:
    """The stage and the plant under audit, and the length of the tracking runs in s.

    `cells` is the fineness of the slotted field. Of the guide springs, "known" means in plant and (12), "unknown" in
    the plant alone, "absent" in neither.
    """

    stage: Stage
    plant: Plant
    duration_s: float = experiments.TRACK_TO
    cells: int = 12

    @cached_property
    def without_springs(self) -> Plant:
        """The plant without guide springs."""
        return self.plant.with_parameters(**dict.fromkeys(SPRINGS, 0.0))

    def pair(self, springs: Springs) -> tuple[Plant, Plant]:
        """Return the plant, and the one that (12) takes it for."""
        plant = self.without_springs if springs == "absent" else self.plant
        return plant, self.plant if springs == "known" else self.without_springs


@lru_cache(maxsize=KEPT)
def ideal(bench: Bench, four: bool, springs: Springs, lv3: str = "csch2") -> continuous.Motion:
    """Return the ideal 4-DOF tracking or ellipse under (12), with this reading of L_v3 in plant and law."""
    courses = {axis: experiments.COURSES[axis] for axis in ("y", "x", "z")}
    if four:
        courses |= {"phi": Sine(0.0, control.OMEGA0), "theta": experiments.COURSES["theta"]}
    return continuous.run(*bench.pair(springs), courses, {"y": 0.020, "x": -0.03}, bench.duration_s / 3, lv3)


def ideal_errors(bench: Bench, four: bool, springs: Springs, lv3: str = "csch2") -> dict[str, float]:
    """Return the mean |e| of an ideal run by axis, um or urad; NaN when the gap left its range."""
    motion = ideal(bench, four, springs, lv3)
    return {axis: 1e6 * motion.mean_error(axis, bench.duration_s / 5) for axis in motion.error}


@lru_cache(maxsize=KEPT)
def encoder_errors(
    bench: Bench, four: bool, restored: bool, springs: Springs = "known", guided: bool = False
) -> dict[str, float]:
    """Return the mean |e| by axis of the compiled loop, um or urad; `guided` adds friction and cogging."""
    plant, known = bench.pair(springs)
    added = maglev_stage.guides(bench.plant, FRICTION, bench.cells) if guided else None
    rig = Rig(bench.stage, plant, _controller(known, restored), disturbance=added)
    trajectory, courses = experiments.tracking(rig, four, bench.duration_s)
    return {a: 1e6 * e for a, e in experiments.mean_errors(trajectory, courses, bench.duration_s / 6).items()}


@lru_cache(maxsize=KEPT)
def _controller(known: Plant, restored: bool) -> host.Controller:
    # The library computes the functions, which for new parameters none has fitted.
    return build.compiled(control.controller(known, restored).block, np.float64, libm=True)
