"""From a planar controller, its reference and experiments to everything that the command line does with a design."""

from collections.abc import Callable, Iterator, Mapping
from functools import cache, partial
from typing import Any

from designs.planar_6dof import bench, emitted, experiments, interface, loop, verification
from designs.planar_6dof.experiments import Parts
from designs.planar_6dof.random_steps import Subject
from models import halbach, planar_stage
from synth import stage
from synth.report.audit import Row
from synth.simulate.rig import Rig
from synth.workspace import Design

QUICK_REPLAY, WHOLE_REPLAY = 5.0, 60.0  # s of a closed loop that the reference replays


def design(
    subject: Subject,
    gains: Callable[[], Mapping[str, Any]],
    parts: Parts,
    audit: Callable[[Rig], Iterator[Row]],
    report: Callable[..., str],
) -> Design:
    """Return the design; `gains` returns what gains.json says, `audit` the rows of the paper from the shipped loop."""
    shipped = cache(lambda: loop.of(subject.block))
    return stage.design(
        interface.declared(subject.block),
        planar_stage.plant(halbach.HARMONICS),
        reference=subject.reference,
        surrogate_error=interface.SURROGATE_ERROR,
        emit=lambda scalar: emitted.emitted(subject.block, scalar, gains()),
        verify=lambda progress, whole: verification.verify(subject, progress, WHOLE_REPLAY if whole else QUICK_REPLAY),
        simulate=lambda progress: experiments.run(parts, shipped(), progress),
        audit=lambda: audit(shipped()),
        bench=bench.of(subject.block, partial(experiments.run, parts)),
        report=report,
    )
