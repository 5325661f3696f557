"""The estimator in the report: its tuning, the sensors that ship, and the chain before it."""

from collections.abc import Mapping
from math import degrees, pi

from designs.hall_position import shipped
from models import hall_chain
from models.hall_chain import Chain
from synth.report import page
from synth.report.prose import Value


def blocks(meaning: Mapping[str, str]) -> dict[str, Value]:
    """Return the tuning with what each number means, the sensors, and the chain."""
    tuning = vars(shipped.TUNING)
    rows = tuple((name, float(tuning[name]), about) for name, about in meaning.items())
    return {
        "estimator.tuning": page.Table("Tuning", ("name", "value", "is"), rows),
        "estimator.arrays": _arrays(),
        "estimator.chain": _chain(),
    }


def _arrays() -> page.Table:
    rows: list[tuple[page.Cell, ...]] = []
    for name in shipped.PLACES:
        of = shipped.array(name)
        places = ", ".join(f"({x / of.pitch:.3f}, {y / of.pitch:.3f})".replace("-", "−") for x, y in of.positions)
        rows.append((name, len(of.positions), places, of.alpha, of.beta, 1e3 * of.deviation))
    columns = ("emitted as", "sensors", "at, pitches in the body", "α, V", "β, V", "noise, mV")
    return page.Table("Sensors and their field", columns, tuple(rows), digits=6)


def _chain() -> page.Table:
    chain, time = Chain(), shipped.TIME
    lag = 1 / (2 * pi * chain.corner)
    white = hall_chain.correlation(chain, time)
    rows: tuple[tuple[page.Cell, ...], ...] = (
        ("lag of the filter at a constant speed", 1e3 * lag, "ms", f"{1e3 * lag:.3g} µm for each mm/s"),
        ("phase of the filter at 20 Hz", -degrees(2 * pi * 20 * lag), "°", "of first order, below the corner"),
        ("correlation of the noise of two samples", white, "1", "white before the filter"),
        ("converter's step", 1e3 * chain.step, "mV", f"{chain.bits} bits over ±{chain.span:g} V, assumed"),
        ("its error", 1e3 * chain.step / 12**0.5, "mV rms", f"beside the noise of {1e3 * chain.noise:g} mV"),
    )
    return page.Table("Chain at 800 Hz", ("what", "value", "unit", "note"), rows, digits=3)
