"""Estimator in the report: tuning, shipped sensors, and the signal chain before it."""

from collections.abc import Mapping
from math import degrees, pi

from designs.hall_position import config
from designs.hall_position.protected import config as protected
from models import hall_chain
from models.hall_chain import Chain
from models.hall_two_waves import PlanarArray
from synth.report.prose import Content, Rows


def blocks(meaning: Mapping[str, str]) -> dict[str, Content]:
    """Return the tuning with the meaning of each number, the sensors, and the chain."""
    tuning = vars(config.TUNING)
    arrays = {config.NAME: config.array()} | {name: protected.array(name) for name in protected.PLACES}
    return {
        "estimator.tuning": [(name, float(tuning[name]), about) for name, about in meaning.items()],
        "estimator.arrays": [_array(name, array) for name, array in arrays.items()],
        "estimator.chain": _chain(),
    }


def _array(name: str, array: PlanarArray) -> tuple[str | float, ...]:
    places = ", ".join(f"({x / array.pitch:.3f}, {y / array.pitch:.3f})".replace("-", "−") for x, y in array.positions)
    return name, len(array.positions), places, array.alpha, array.beta, 1e3 * array.deviation


def _chain() -> Rows:
    chain, time = Chain(), config.TIME
    lag = 1 / (2 * pi * chain.corner)
    white = hall_chain.correlation(chain, time)
    return [
        ("lag of the filter at a constant speed", 1e3 * lag, "ms", f"{1e3 * lag:.3g} µm for each mm/s"),
        ("phase of the filter at 20 Hz", -degrees(2 * pi * 20 * lag), "°", "of first order, below the corner"),
        ("correlation of the noise of two samples", white, "1", "white before the filter"),
        ("converter's step", 1e3 * chain.step, "mV", f"{chain.bits} bits over ±{chain.span:g} V, assumed"),
        ("its error", 1e3 * chain.step / 12**0.5, "mV rms", f"beside the noise of {1e3 * chain.noise:g} mV"),
    ]
