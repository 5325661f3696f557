"""Which steps of the controller are measured and replayed.

The costliest step is looked for where the code branches: in closed loops, saturated ones too, on every way to the
latch, on the corners of the ranges until the internal models stand at their bounds, and at states drawn at random.
"""

from collections.abc import Callable
from itertools import product

import numpy as np
from numpy.typing import NDArray

from designs.maglev_5dof import control, experiments
from designs.maglev_5dof.loop import Loop
from models import maglev_stage
from synth.execute import host
from synth.simulate.scenario import sample_times
from synth.simulate.sensors import Override
from synth.verify import steps
from synth.verify.steps import Steps

FLOOR = 1.0  # A, below which a difference of currents is absolute
REPLAY = 10_000  # steps
EACH = 2000  # steps of each experiment: its step, or its fault, comes at sample 1000
RANDOM, DRAWN = 2000, 20_000
HELD, RESONANT, KEPT = 40_000, 60_000, 400  # steps until an internal model stands at its bound, and the last of them
AT_REST = {g.signal.name: 0.025 if g.signal.name.startswith("y") else 0.0 for g in control.INPUTS}


def replay(controller: host.Controller) -> dict[str, NDArray[np.floating]]:
    """Return the controller's inputs (10,000,) in the 4-DOF tracking with encoders, bad samples and the latch."""
    time = sample_times(REPLAY * control.TIME.period_s, control.TIME.period_s)
    references = experiments.reference_4dof(time)
    start = {n: float(references[f"{n}_ref"][0]) for n in ("y", "x", "z")}
    masks = {
        "y2": time % 0.25 < 1e-9,
        "theta_ref": time % 0.3 < 1e-9,
        "x": (time > 4.1) & (time < 4.1045),
        "y1": (time > 6.1) & (time < 6.1025),
        "z": time > 9.5,
    }
    bad = {"y2": np.nan, "theta_ref": 1.0, "x": np.inf, "y1": -1.0, "z": np.nan}
    overrides = {name: Override(mask, np.full(REPLAY, bad[name])) for name, mask in masks.items()}
    run = Loop(maglev_stage.plant(), controller).run(
        REPLAY * control.TIME.period_s, start, references, overrides=overrides
    )
    return dict(run.measured)


def sequences(controller: host.Controller, told: Callable[[str], None]) -> list[Steps]:
    """Return every sequence, closed loops first."""
    told("sequences")
    return [
        *closed_loops(controller),
        steps.faulty(controller, AT_REST),
        steps.in_range(controller, RANDOM),
        *_corners(controller),
        *_resonances(controller),
        steps.drawn(controller, DRAWN),
    ]


def closed_loops(controller: host.Controller) -> list[Steps]:
    """Return the first steps of each experiment, under the shipped controller."""
    loop = Loop(maglev_stage.plant(), controller)
    runs = experiments.run(loop, loop, lambda _: None)
    shown = [r for r in runs if r.name != "windup_without"]  # here it would be the one with
    return [
        steps.recorded(controller, r.name, {n: v[:EACH] for n, v in r.trajectory.measured.items()}, closed_loop=True)
        for r in shown
    ]


def _corners(controller: host.Controller) -> list[Steps]:
    """Hold inputs on the ends of their ranges until the internal models stand: at their bounds, or by anti-windup."""
    ends = {g.signal.name: (g.signal.low, g.signal.high) for g in control.INPUTS}
    found = []
    for measured, wanted, tilt in product((0, 1), (0, 1), (0, 1)):
        at = {name: ends[name][wanted if name.endswith("_ref") else measured] for name in ends}
        # Opposite gaps apart tilt the platen; alike they do not.
        at |= {name: ends[name][1 - measured] for name in ("y3", "y4") if tilt}
        held = steps.recorded(controller, "corners held", {n: np.full(HELD, v) for n, v in at.items()})
        found += [held.part(slice(0, KEPT)), held.part(slice(-KEPT, None))]
    return [steps.joined("corners held", found)]


def _resonances(controller: host.Controller) -> list[Steps]:
    """Swing the measurements over their ranges at the internal models' own frequency."""
    wave = np.sin(control.OMEGA0 * control.TIME.period_s * np.arange(RESONANT))
    inputs = dict.fromkeys(AT_REST, np.zeros(RESONANT)) | {"y_ref": np.full(RESONANT, 0.025)}
    for g in (g.signal for g in control.INPUTS if g.measurement):
        turn = -1 if g.name in ("y3", "y4") else 1
        inputs[g.name] = (g.low + g.high) / 2 + 0.499 * turn * (g.high - g.low) * wave
    swung = steps.recorded(controller, "swung at resonance", inputs)
    return [swung.part(slice(-4 * KEPT, None))]
