"""Audit of the loops: poles, steps and tracking errors; `bench` says what "ideal" and "encoders" mean."""

from collections.abc import Mapping
from functools import partial

import numpy as np

from designs.maglev_5dof import control
from designs.maglev_5dof.paper import bench as benches
from designs.maglev_5dof.paper.bench import GROUPS, Bench, Springs
from synth.report.audit import Outcome, Published, recomputes
from synth.synthesise.feedback import inverse_lqr

NEAR = 0.10  # a tracking error agrees within this part of the printed one
SPRING_CASES: tuple[Springs, ...] = ("absent", "known", "unknown")
_TRACKED = (("y", "um"), ("theta", "urad"))


def _poles(name: str, bench: Bench, printed: Published) -> Outcome:
    """Recompute the closed-loop poles of an axis from its LQR weights."""
    poles = np.linalg.eigvals(benches.closed_loop(name))
    first, second = sorted(poles[poles.imag > 1e-9], key=lambda pole: -pole.imag)
    recomputed = {"fast": float(poles[np.abs(poles.imag) < 1e-9].real[0])}
    for pair, pole in (("first", first), ("second", second)):
        recomputed |= {f"{pair}_real": float(pole.real), f"{pair}_imaginary": float(pole.imag)}
    inverse = inverse_lqr.diagonal_weights(control.axis_plant(benches.axis(name)), _printed_poles(printed))
    figures = [(n.replace("_", " pair, "), value, "1/s") for n, value in recomputed.items()]
    recovered = zip(("e", "de", "xi1", "xi2", "xi3"), inverse.q, strict=True)
    figures += [(f"weight on {state} from the printed poles", q, "1") for state, q in recovered]
    figures.append(("diagonal weights that give the printed poles, free directions", inverse.nullspace.shape[1], "1"))
    return Outcome(figures, all(printed[n].agrees(value) for n, value in recomputed.items()))


def _printed_poles(printed: Published) -> list[complex]:
    pairs = [complex(printed[f"{n}_real"].value, printed[f"{n}_imaginary"].value) for n in ("first", "second")]
    return [complex(printed["fast"].value), *(s for pair in pairs for s in (pair, pair.conjugate()))]


poles_y, poles_x, poles_theta = (
    recomputes(row)(partial(_poles, name)) for row, name in (("F-8", "y"), ("F-9", "x"), ("F-10", "theta"))
)


@recomputes("F-15", *GROUPS["turning"])
def tracking(bench: Bench, printed: Published) -> Outcome:
    """Recompute the mean errors of the 4-DOF tracking."""
    cases = {f"ideal, springs {s}": benches.ideal_errors(bench, True, s) for s in SPRING_CASES}
    cases |= {
        f"encoders, printed law, springs {s}": benches.encoder_errors(bench, True, False, s) for s in SPRING_CASES
    }
    near = any(_within({n: errors[n] for n, _ in _TRACKED}, printed) for errors in cases.values())
    cases["encoders, shipped law, springs known"] = benches.encoder_errors(bench, True, True)
    figures = [(f"{n}, {name}", errors[n], unit) for name, errors in cases.items() for n, unit in _TRACKED]
    lost = benches.ideal(bench, True, "absent", "coth2").left_at
    figures.append(("time at which the gap leaves 18 .. 31 mm, ideal, coth^2, springs absent", lost, "s"))
    return Outcome(figures, False, near)


def _within(errors: Mapping[str, float], printed: Published) -> bool:
    return all(abs(v / printed[n].value - 1) <= NEAR for n, v in errors.items())
