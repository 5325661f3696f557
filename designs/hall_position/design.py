"""Absolute position from Hall voltages, after Kawato and Kim: from the magnets' geometry to verified C."""

import numpy as np

from designs.hall_position import bench, emitted, page, shipped, verification
from designs.hall_position.loop import experiments
from designs.hall_position.paper import rows
from synth.workspace import Bench, Design

DESIGN = Design(
    name=shipped.NAME,
    scalar=np.float32,
    emit=emitted.emitted,
    verify=verification.verify,
    simulate=experiments.run,
    audit=rows.rows,
    bench=Bench(shipped.block, bench.replay, bench.sequences, bench.FLOOR),
    report=page.report,
)
