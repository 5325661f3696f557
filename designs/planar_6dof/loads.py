"""What a sound platen withstands in the campaign's motion: cables, a wavy field, noise, the floor, the drives.

Half of what the motors can make is a steady load, 12 N in x and 24 N in y. The field of a matrix whose blocks are not
alike has harmonics that the sensing does not know: a share of the fundamental in the third and the fifth. All at once
are half of each, but for the forces.
"""

from collections.abc import Sequence
from dataclasses import replace

import casadi as ca

from designs.planar_6dof import interface
from models import halbach, planar_stage
from synth.declare.effects import Amplifiers, Cable, Changed, CurrentLoops, Effect, Floor, Force, Readings
from synth.declare.experiments import Conditions, Withstand
from synth.plant import Plant
from synth.signals import Parameter

FORCE_X = 12.0  # N
CABLE, PRELOAD = 50.0, 5.0  # N/m, N
WAVES, SHARE = (3, 5), 0.02
FLOOR = 0.3  # m/s^2 rms
LAG = 3e-4  # s
GAIN, OFFSET = 0.02, 0.01  # of the amplifiers; A
TOGETHER = 0.5
EXTRA = "wave_share"


def with_waves(plant: Plant, share: float) -> Plant:
    """Return the plant whose Hall voltages see harmonics of `SHARE` of the fundamental each, times `share`."""
    x, u, p, part = (ca.SX.sym(n, plant.h.size1_in(i) if i < 3 else 1) for i, n in enumerate(("x", "u", "p", "part")))
    states = dict(zip((s.name for s in plant.states), ca.vertsplit(x), strict=True))
    values = dict(zip((q.name for q in plant.parameters), ca.vertsplit(p), strict=True))
    y = plant.h(x, u, p)
    for sensor, r in (("a", (0, 0)), ("b", (values["spacing"], 0)), ("c", (0, values["spacing"]))):
        at = planar_stage.place(states, ca.SX(r[0]), ca.SX(r[1]))
        w, A = halbach.wave_number(values), halbach.amplitude(1, values["height"] + at.lift, values)
        along = [sum(A * ca.sin(n * w * q) for n in WAVES) for q in (at.X, at.Y)]
        c, s = ca.cos(states["phi"]), ca.sin(states["phi"])
        for axis, seen in (("x", c * along[0] + s * along[1]), ("y", c * along[1] - s * along[0])):
            y[[o.name for o in plant.outputs].index(f"V_{sensor}{axis}")] += part * values["sensitivity"] * seen
    f = ca.Function("f", [x, u, ca.vertcat(p, part)], [plant.f(x, u, p)])
    h = ca.Function("h", [x, u, ca.vertcat(p, part)], [y])
    parameters = (*plant.parameters, Parameter(EXTRA, SHARE * share, "1", 0.0, "of the fundamental"))
    return replace(plant, parameters=parameters, f=f, h=h)


def experiments(force_y: float) -> tuple[Withstand, ...]:
    """Return the experiments, each effect alone and then all at once, with a force in N along y."""
    cables = [Cable(axis, CABLE, PRELOAD) for axis in "xy"]
    noise = Readings(planar_stage.HALL, noise=interface.NOISE_PRINTED * interface.VOLTS_PER_METRE)
    single: dict[str, Sequence[Effect]] = {
        "force_x": [Force("x", FORCE_X)],
        "force_y": [Force("y", force_y)],
        "cables": cables,
        "waves": [Changed("waves", with_waves)],
        "noise": [noise],
        "floor": [Floor(("x", "y"), FLOOR)],
        "currents": [CurrentLoops(LAG), Amplifiers(GAIN, OFFSET)],
    }
    # Both forces at once need 24 N of motor A, all that it has: A and B make up for the torque of C's push along x.
    every = [effect.scaled(TOGETHER) for name, e in single.items() if not name.startswith("force") for effect in e]
    runs = [Withstand(f"withstands_{name}", Conditions(effects=e), 10.0) for name, e in single.items()]
    return (*runs, Withstand("withstands_all", Conditions(effects=every), 60.0))
