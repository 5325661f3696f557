"""Which steps of the LQG controller are measured and replayed."""

from designs.planar_6dof import bench
from designs.planar_6dof_lqg import experiments
from synth.execute import host
from synth.verify.steps import Steps

FLOOR, replay = bench.FLOOR, bench.replay


def sequences(controller: host.Controller, told: bench.Told) -> list[Steps]:
    """Return every sequence, closed loops first."""
    return bench.sequences(controller, experiments.run, told)
