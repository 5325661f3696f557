"""Configuration of the published estimator, of two sensors.

The field is that of the fabricated matrix at the sensors' height, from the blocks' remanences, times the chain's V/T.
"""

from dataclasses import asdict, dataclass, replace
from functools import cache
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from designs.hall_position.glsdc import channels, estimator
from designs.hall_position.glsdc.parameters import Tuning
from models import hall_array, hall_two_waves, papers
from models.hall_array import Pair
from models.hall_stage import PUBLISHED, Stage
from models.hall_two_waves import PlanarArray as Array
from synth import stage
from synth.block import Block
from synth.blocks.estimate import glsdc_estimator
from synth.declare.stage import Controller
from synth.signals import signal_names
from synth.stage import Sensor
from synth.synthesise import digits
from synth.timing import Discrete

NAME = "hall_position"
TIME = Discrete(1 / 800)
UNPROTECTED = (
    "two sensors have no fault protection. A failed sensor may leave no residual, and an estimate may be valid and "
    "wrong. The deviations hold for the field of the model only, two waves along each axis whose voltages are right to "
    "the noise of 1 mV rms. In the field of the fabricated matrix or of a finite one, with an amplitude 2 % low, or "
    "with gains that differ by 1 %, they are 20 to 1,800 times too small."
)
PLACES = PUBLISHED[:2]  # in pitches
TUNING = Tuning()


@dataclass(frozen=True)
class ColdStart:
    """What header and experiment ask of a body from `init` on: one revolution on a circle, within half a pitch.

    Radius in m, speeds along the circle in m/s, yaw in degrees to either side; the least share of starts that are valid
    within the revolution, and the largest of those that are if the body rests.
    """

    radius: float = 6e-3
    slowest: float = 0.05
    fastest: float = 0.2
    yaw: float = 2.4
    valid: float = 0.95
    at_rest: float = 0.3

    @property
    def longest_s(self) -> float:
        """The time of a revolution at the lowest speed, s."""
        return 2 * pi * self.radius / self.slowest


COLD_START = ColdStart()
DIGITS = 6  # digits kept of the field, which makes it the same on every machine


def array() -> Array:
    """Return the array of the estimator: positions, field in V and noise."""
    return array_at(PLACES)


@cache
def array_at(places: tuple[Pair, ...]) -> Array:
    """Return an array of sensors at places in pitches."""
    made = Stage().array(places)
    alpha, beta = (digits.significant(v, DIGITS) for v in (made.alpha, made.beta))
    return replace(made, alpha=alpha, beta=beta)


def controller() -> Controller:
    """Return the guarded estimator."""
    planar_array = array()
    volts = channels.voltages(len(planar_array.positions))
    body = hall_array.plant(*hall_two_waves.model(planar_array), volts, TUNING.pitches * planar_array.pitch)
    interface = stage.interface(
        body,
        sensors=[Sensor(s.name) for s in body.outputs],
        disturbances=signal_names(body.inputs),
        bad_samples=channels.BAD_SAMPLES,
        safe_output_effect=glsdc_estimator.SAFE_OUTPUT_EFFECT,
    )
    return stage.controller(NAME, TIME, interface, lambda: [estimator.estimator(planar_array, TIME, TUNING)])


def header_notes() -> list[str]:
    """Return the sentences of the C's header."""
    of = COLD_START
    return stage.read_notes(
        Path(__file__).parents[1] / "header.md",
        yaw=of.yaw,
        radius=1e3 * of.radius,
        slowest=1e3 * of.slowest,
        fastest=1e3 * of.fastest,
        longest=of.longest_s,
        valid=100 * of.valid,
        at_rest=100 * of.at_rest,
        paper=papers.KAWATO,
    )


def block() -> Block:
    """Return the guarded estimator as a Block."""
    return controller().block


def gains(scalar: type[np.floating]) -> dict[str, Any]:
    """Return the content of gains.json: model, sensors, tuning, and sources of the numbers."""
    return document(
        PLACES,
        TUNING,
        "B_X = alpha sin(w X) + beta sin(5 w X), B_Y likewise in Y: (2), for the fabricated matrix at 3 mm",
        "modified Gaussian least squares differential correction (GLSDC), Fig. 9, a fixed number a sample",
    )


def document(places: tuple[Pair, ...], tuning: Any, model: str, method: str) -> dict[str, Any]:
    """Return the content of gains.json of an estimator, by its sensors in pitches and its dataclass of tuning."""
    of = array_at(places)
    return {
        "model": model,
        "alpha_V": of.alpha,
        "beta_V": of.beta,
        "pitch_m": of.pitch,
        "deviation_V": of.deviation,
        "positions_pitches": [list(place) for place in places],
        "period_s": TIME.period_s,
        "method": method,
        "tuning": {k: digits.significant(v, 12) if isinstance(v, float) else v for k, v in asdict(tuning).items()},
        "bad_samples": channels.BAD_SAMPLES,
    }
