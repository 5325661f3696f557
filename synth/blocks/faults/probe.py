"""Probe of a sensor at rest: small doublet pairs of acceleration, until the code changes once.

    +a for n samples, -a for 2 n, +a for n:   the body moves by a (n T)^2 and stands still again, there and back

At rest a working sensor stays in one count only while nothing moves the body. After `quiet` samples without a change
the probe moves it, at first by `step`, then by 2 `step` and so on, towards the set-point. Each pair runs to its end,
so it leaves no speed. The first after which the code has changed is the last. Without `attempts` answers the sensor is
frozen, and who reads ``unanswered`` decides what follows. A body that moves by one `step` more in each pair passes the
edge of a count by at most one `step`. With `both_sides` pair k moves it by (1 + k/2) `step`, to the other side than
the pair before: the nearer edge of a count is at most half a count away, so smaller and fewer pairs are enough, and the
body passes the edge by at most 1.5 `step`.

Friction F of a mass m allows no motion while a <= F/m, and viscous friction makes the motion smaller: `attempts` pairs
must move the body by more than one count in spite of both. A body on a stop is not to be probed: ``free`` is then 0.

Source: active fault diagnosis; Campbell, Nikoukhah, *Auxiliary Signal Design for Failure Detection*, 2004, chapter 1.
"""

from dataclasses import dataclass, replace

import casadi as ca

from synth import arguments
from synth.block import Block, Constant, Exprs, State, Step, build, clip
from synth.errors import SignalError
from synth.fault import Failure
from synth.law import label
from synth.signals import Signal
from synth.timing import Discrete

__all__ = ["Probe", "block"]

ANSWER = 3  # samples from the end of a pair to the last answer: delay, rounding of the sensor, one more


@arguments.checked
@dataclass(frozen=True)
class Probe:
    """Samples without a change before it, samples n of a quarter, the first displacement a (n T)^2, pairs at most.

    With `both_sides` the pairs alternate between both directions.
    """

    quiet: int
    quarter: int
    step: float
    attempts: int
    both_sides: bool = False

    @property
    def pair(self) -> int:
        """Samples of a pair with its answer."""
        return 4 * self.quarter + ANSWER

    @property
    def samples(self) -> int:
        """Samples without a change after which a sensor is frozen."""
        return self.quiet + self.attempts * (self.pair + 1) + 1

    @property
    def count_limit(self) -> int:
        """Largest count of samples without a change that the probe asks for."""
        return max(self.quiet, self.pair)


@arguments.checked
def block(time: Discrete, sensor: str, error: Signal, demand: Signal, probe: Probe) -> Block:
    """Return the Block from ``<w>_unprobed``, ``<sensor>_unchanged`` and ``free`` to the demand w.

    Its output ``<sensor>_unanswered`` says that none of the `attempts` was answered. `error` is the tracking error of
    the sensor's coordinate.

    Raises SignalError for samples or attempts below 1, or a step that is not positive.
    """
    if min(probe.quiet, probe.quarter, probe.attempts) < 1 or not probe.step > 0:
        raise SignalError(f"the probe of '{sensor}' is {probe}: give at least 1 sample and attempt and a positive step")
    a, n, pair = probe.step / (probe.quarter * time.period_s) ** 2, probe.quarter, probe.pair
    about = f"moves the body by {probe.step:g} {error.unit} and back in {4 * n} samples"
    numbers = [
        Constant("first_push", a, demand.unit, f"acceleration of the first pair, which {about}"),
        Constant("quiet_samples", probe.quiet, "1", "without a change of the code until it probes", ("unchanged",)),
        Constant("first_push_end", n, "1", "last sample of the first push of a pair", ("sample",)),
        Constant("reverse_push_end", 3 * n, "1", "last sample of the push to the other side", ("sample",)),
        Constant("last_push_end", 4 * n, "1", "last sample of the second push", ("sample",)),
        Constant("pair_samples", pair, "1", "of a pair with its answer", ("sample", "unchanged")),
        Constant("largest_demand", demand.high, demand.unit, "bound of the demand with a push"),
        Constant("most_attempts", probe.attempts, "1", "pairs without an answer: the sensor is frozen", ("attempt",)),
    ]

    def law(u: Exprs, x: Exprs, k: Exprs) -> Step:
        w, still = u[f"{demand.name}_unprobed"], u[f"{sensor}_unchanged"]
        runs, waits = x["sample"] >= 1, still >= probe.quiet
        active = ca.logic_or(runs, waits)
        ends = x["sample"] >= pair
        sample = ca.if_else(runs, ca.if_else(ends, 0, x["sample"] + 1), u["free"])
        one_more = x["attempt"] + 1
        failures = ca.if_else(x["attempt"] >= probe.attempts, x["attempt"], one_more)
        after = ca.if_else(ends, ca.if_else(still >= pair, failures, 0), x["attempt"])
        attempt = ca.if_else(runs, after, x["attempt"])
        other = ca.if_else(ends, -x["towards"], x["towards"]) if probe.both_sides else x["towards"]
        to_set_point = ca.if_else(u[error.name] > 0, -a, a)
        to_set_point = ca.if_else(x["attempt"] >= 1, x["towards"], to_set_point) if probe.both_sides else to_set_point
        towards = ca.if_else(runs, other, to_set_point)
        inner = ca.logic_and(x["sample"] > n, x["sample"] <= 3 * n)
        push = x["towards"] * ((x["attempt"] / 2 if probe.both_sides else x["attempt"]) + 1)
        pulse = ca.if_else(x["sample"] <= 4 * n, ca.if_else(inner, -push, push), 0.0)
        output = {
            demand.name: ca.if_else(active, ca.if_else(runs, clip(w + pulse, demand), w), w),
            f"{sensor}_unanswered": x["attempt"] >= probe.attempts,
        }
        next = {"sample": sample, "attempt": attempt, "towards": towards}
        idle = {"sample": ca.SX(0), "attempt": ca.SX(0), "towards": x["towards"]}
        label(
            active=active, runs=runs, waits=waits, ends=ends, one_more=one_more, to_set_point=to_set_point, push=push,
            pulse=pulse, other=other,
        )  # fmt: skip
        return Step(output, {n: ca.if_else(active, value, idle[n]) for n, value in next.items()}, numbers=numbers)

    unchanged = Signal(f"{sensor}_unchanged", "1", 0, 1e6, "samples without a change of the code")
    plain = Signal(f"{demand.name}_unprobed", demand.unit, demand.low, demand.high, demand.about)
    # `towards` is +-a by its law; a bound at a itself would look like a state at its limit.
    states = [
        State(Signal("sample", "1", 0, pair, "sample of the pair, 0 for none"), 0, True),
        State(Signal("attempt", "1", 0, probe.attempts, "pairs without an answer"), 0, True),
        State(Signal("towards", demand.unit, -2 * a, 2 * a, "acceleration of the first pair, to the set-point"), a),
    ]
    unanswered = Signal(f"{sensor}_unanswered", "1", 0, 1, "no pair of the probe was answered")
    free = Signal("free", "1", 0, 1, "the body may move")
    made = build(
        f"probe_{sensor}", time, law, inputs=[plain, unchanged, error, free], outputs=[demand, unanswered],
        states=states, tag="probe at rest",
    )  # fmt: skip
    noticed = f"{probe.quiet} samples without a change of its code, then {probe.attempts} pairs of pushes without an "
    noticed += f"answer: after {probe.samples} samples; only while all is measured and the body is free"
    row = Failure(f"unanswered_{sensor}", f"{sensor} frozen at rest", noticed, "its prediction", "as frozen in motion",
                  (), (sensor,))  # fmt: skip
    return replace(made, failures=(row,))
