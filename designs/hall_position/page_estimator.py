"""The report's part on the estimator: what it minimises, how it goes from sample to sample, and with which numbers."""

from dataclasses import fields
from math import degrees, pi

from designs.hall_position import shipped
from designs.hall_position.glsdc.parameters import Tuning
from models import hall_chain
from models.hall_chain import Chain
from synth.report import page

LAW = (
    ("", "[a; b] = R(θ)' B(P),  P = (X, Y) + R(θ) r,  B_X = c + α sin(ω X) + β sin(5 ω X),  B_Y likewise"),
    (
        "Fig. 9",
        "min J(d) = Σ_{sensors} |R(θ) V - B(P)|^2 + λ (U^2 + V^2 + (firm ρ)^2 T^2),  "
        "d = (U, V, T) from the expected pose",
    ),
    ("Fig. 9", "d ← d + scale (H' W H + λ)^{-1} H' W e,  n times"),
    ("", "J(d_i) > J(best):  d_{i+1} = (best + d_i) / 2"),
    ("", "N_T = λ (firm ρ)^2 + Σ_{axes} [Σ_{pairs} (g_i h_j - g_j h_i)^2 + λ Σ h^2] / (λ + Σ g^2)"),
    ("", "sin(p + u) = sin p cos u + cos p sin u,  sin 5p = sin p (5 - 20 sin^2 p + 16 sin^4 p)"),
    ("", "motion ← motion + follow d,  expected pose ← pose + motion"),
)
MEANING = {
    "iterations": "corrections in a sample, always as many",
    "scale": "of each correction; α of the paper is 0.2",
    "damping": "λ over α² of (2): it holds what the voltages do not tell to the expected motion",
    "firm": "times as firmly as the phases the yaw is held to the expected one, at the sensors' mean arm",
    "reach": "rad of phase by which a sample's corrections may move a sensor",
    "follow": "part of a sample's correction by which the next motion is expected to differ",
    "settled": "standard deviations: a smaller correction has converged",
    "leaning": "parameters that the damping may decide before the estimate is damped",
    "surprise": "deviations of a motion from the expected one that no body makes",
    "residual": "V rms up to which residuals are those of the field's model",
    "certain": "parameters that the damping may decide where a place becomes certain",
    "turn": "rad of yaw, from that of the last certain place, within which places are told apart",
    "yaw": "rad, beyond which nothing is valid, and not again until init",
    "pitches": "to either side over which positions are counted",
}


def estimator() -> page.Section:
    """Return the estimator's equations, the numbers that ship and the chain before it."""
    text = page.Text(
        "Gaussian least squares differential correction in a fixed time: n corrections whatever the voltages, of which "
        "none may raise the cost. A sample begins where the last motion leads; sines and cosines of that pose are "
        "computed once, and each correction turns them by a small angle. In the field's axes the Jacobian is sparse: "
        "X and Y are eliminated one by one, and what is left for the yaw is a sum of squares, by Lagrange's identity, "
        "so that nothing large is subtracted. Where the voltages do not tell all of the pose the damping holds the "
        "rest to the expected motion instead of letting it jump, and the output says damped. No function of a library "
        "is called.\n\n"
        "valid is an estimate that has converged, whose place is the only one, that is not damped, leaves residuals as "
        "small as the field's model does, is no motion that a body cannot make, and rests on accepted measurements. "
        "The deviations of X, Y and yaw are outputs too. The voltages are the same when body and place are turned by "
        "90° about a strong block: the yaw is known to a quarter turn and goes on from the last one."
    )
    return page.Section("Estimator", (text, page.Equations(LAW), _tuning(shipped.TUNING), _arrays(), _chain()))


def _tuning(tuning: Tuning) -> page.Table:
    rows = tuple((f.name, float(getattr(tuning, f.name)), MEANING[f.name]) for f in fields(tuning))
    return page.Table("Tuning", ("name", "value", "is"), rows)


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
    rows: tuple[tuple[page.Cell, ...], ...] = (
        ("lag of the filter at a constant speed", 1e3 * lag, "ms", f"{1e3 * lag:.3g} µm for each mm/s"),
        ("phase of the filter at 20 Hz", -degrees(2 * pi * 20 * lag), "°", "of first order, below the corner"),
        (
            "correlation of the noise of two samples",
            hall_chain.correlation(chain, time),
            "1",
            "white before the filter",
        ),
        ("converter's step", 1e3 * chain.step, "mV", f"{chain.bits} bits over ±{chain.span:g} V, assumed"),
        ("its error", 1e3 * chain.step / 12**0.5, "mV rms", f"beside the noise of {1e3 * chain.noise:g} mV"),
    )
    return page.Table("Chain at 800 Hz", ("what", "value", "unit", "note"), rows, digits=3)
