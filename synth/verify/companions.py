"""Verification of the Blocks beside a controller that have a reference: all witnesses, and single against double.

random, edge    states uniform in their bounds, inputs in their ranges, at their ends, beyond, or NaN
replay          what a companion reads in recorded closed loops, from `init`
"""

from collections.abc import Mapping

import numpy as np

from synth.declare.companion import Companion
from synth.declare.stage import Stage
from synth.verify import agree, sampling, suite
from synth.verify.agree import Agreement


def compare(
    companion: Companion,
    label: str,
    stage: Stage,
    recorded: Mapping[str, agree.Columns],
    rng: np.random.Generator,
    steps: tuple[int, int],
) -> tuple[list[Agreement], Agreement]:
    """Compare all witnesses of a companion, and single with double precision over the random steps.

    `steps` are the numbers of random and of edge steps; `recorded` are its inputs in closed loops of the `stage`.
    """
    assert companion.reference is not None
    by, floor = suite.witnesses(companion.block, companion.reference, stage.surrogate_error), companion.floor
    random = sampling.anywhere(companion.block, rng, steps[0])
    edge = sampling.edge_steps(companion.block, rng, steps[1])
    compared = suite.compare(f"{label}, random steps", by, *random, floor)
    compared += suite.compare(f"{label}, edge steps", by, *edge, floor)
    labelled = {f"{label}, {what}": inputs for what, inputs in recorded.items()}
    double, single = suite.in_both_precisions(by, *random)
    pair = ("c64", double), ("c32", single)
    in_single = agree.compare(f"{label}, random steps", *pair, floor, companion.block, np.float32)
    return [*compared, *suite.replay(by, labelled, floor)], in_single
