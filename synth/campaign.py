"""Fault campaign of a stage as declared: the motion in which faults occur, their magnitudes, and limits (FMEA).

A stage without such a declaration has the default one, without limits. `simulate.campaign` runs it.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class FaultLimit:
    """In every run whose fault matches, the `measure` is at most `most`.

    measure    impact or impact_Q        largest speed of an impact on a stop beyond the healthy run, of position Q
               excursion_Q               largest |q - q of the healthy run| of position Q
               notice_s, latch_s         time from the onset to the first fault bit, to the latch; inf for never
               wrong_names               sensors without a fault that a fault bit names
               false_alarms              samples with a fault bit in the healthy runs

    `target`, `kind`, `condition` and `duration` are patterns of `fnmatch` for the columns of the table. Runs in which
    the fault has no effect count as neither noticed nor late.
    """

    measure: str
    most: float
    target: str = "*"
    kind: str = "*"
    condition: str = "*"
    duration: str = "*"


@dataclass(frozen=True, eq=False)
class FaultCampaign:
    """Conditions, magnitudes and limits of a fault campaign.

    motion       {set-point: course} in motion, from rest at its start; by default each set-point swings as a sine
    period_s     period of the motion, over which the onsets are spread, and of the default motion
    settle_s     from the start of a run to the first onset; `watch_s` from the last onset to the end
    onsets       number of onsets in motion
    durations_s  of faults that are neither permanent nor short
    offset, noise, drift_per_s   of a faulty sensor, as fractions of its range; noise as standard deviation
    bit          the highest bit whose weight is at most this fraction of the sensor's range is flipped or stuck
    jump         of a set-point, as a fraction of its range
    repeated     samples in which a sensor repeats a reading
    weak         fraction of the command that a weak actuator applies
    inertias     {position: plant parameter}, its mass or moment of inertia: impacts on its stop have an energy
    """

    motion: Mapping[str, Any] = field(default_factory=dict)
    period_s: float = 1.0
    settle_s: float = 1.0
    watch_s: float = 1.0
    onsets: int = 2
    durations_s: Sequence[float] = (0.05,)
    offset: float = 0.02
    noise: float = 0.005
    drift_per_s: float = 0.05
    bit: float = 0.05
    jump: float = 0.1
    repeated: int = 10
    weak: float = 0.7
    inertias: Mapping[str, str] = field(default_factory=dict)
    limits: Sequence[FaultLimit] = ()
