"""What is committed under generated_c/: the controller and the commutation, with gains and test vectors."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designs.maglev_5dof import control
from designs.maglev_5dof.loop import Loop
from models import maglev_stage
from synth.emit import digits, vectors, write
from synth.execute import host
from synth.plant import Plant
from synth.simulate.scenario import sample_times
from synth.simulate.sensors import Override
from synth.statespace import Array, readonly
from synth.synthesise import internal_model, lqr

STEPS = 1000
BAD = slice(700, 703)  # samples of the test vectors at which the x encoder reads out of range
BAD_SET_POINT = slice(800, 810)


def emitted(scalar: type[np.floating]) -> dict[str, write.Emitted]:
    """Return the files of maglev_5dof and maglev_5dof_phase in a scalar type, by folder."""
    plant = maglev_stage.plant()
    control.require_invertible(plant)
    controller = write.emit(
        control.controller(plant),
        scalar,
        {"design": gains(plant, scalar)},
        error=control.SURROGATE_ERROR[scalar],
    )
    phase = write.emit(control.phase_currents(plant), scalar)
    recorded = _recorded(plant, host.load(controller.files, controller.manifest))
    commutation = host.load(phase.files, phase.manifest)
    currents = {n: recorded.outputs[n] for n in recorded.outputs} | {n: recorded.inputs[n] for n in ("x", "z")}
    answered = commutation.replay(currents)
    by_phase = vectors.document(currents, answered.outputs, answered.faults)
    return {
        control.NAME: _with(controller, vectors.document(recorded.inputs, recorded.outputs, recorded.faults)),
        f"{control.NAME}_phase": _with(phase, by_phase),
    }


def _with(files: write.Emitted, text: str) -> write.Emitted:
    return replace(files, files={**files.files, "vectors.json": text})


def gains(plant: Plant, scalar: type[np.floating]) -> dict[str, Any]:
    """Return each axis' gain with the weights, plant and rate it came from, its certificate, and lqrd beside it."""
    return {axis.name: _gain(axis, scalar) for axis in control.AXES}


def _gain(axis: control.Axis, scalar: type[np.floating]) -> dict[str, Any]:
    model, period = control.axis_plant(axis), control.TIME.period_s
    Q, R = np.diag(axis.weights), np.eye(1)
    gain = control.gain(axis)
    sampled = lqr.lqrd(model, Q, R, period, exact=True)
    T = internal_model.leapfrog(control.FREQUENCIES, period).T
    ratio = lqr.cost_ratio(model, replace(gain, K=_shipped(axis, T, scalar)), Q, R, period, exact=True)
    certificate = gain.certificate
    return {
        "plant": "q'' = w, xi' = Phi xi + N e, Phi and N for the frequencies below; states e, de, xi1, xi2, xi3",
        "coordinates": "K is on these states; the constants are on e, de, sum, p1, q1 with xi = T (sum, p1, q1)",
        "T": T.tolist(),
        "frequencies_rad_s": list(control.FREQUENCIES),
        "weights_Q": list(axis.weights),
        "weight_R": 1.0,
        "published_weights": axis.name != "phi",
        "period_s": period,
        "K": [float(v) for v in gain.K[0].astype(scalar)],
        "poles_rad_s": [digits.pole(s) for s in gain.poles],
        "certificate": {
            "relative_residual_below": digits.bound(float(certificate.defect.max()) / max(axis.weights)),
            "relative_forward_error_estimate": digits.bound(
                float((certificate.step / np.abs(certificate.X).max()).max())
            ),
        },
        "sampled_data_optimum": {
            "K": [digits.cut(v, 6) for v in sampled.K[0]],
            "worst_cost_ratio_of_K": digits.cut(ratio, 4),
        },
    }


def _shipped(axis: control.Axis, T: Array, scalar: type[np.floating]) -> Array:
    """Return the gain (1, 5) on (e, de, xi) to which the rounded constants on (e, de, eta) amount."""
    block = control.regulator_block(axis).rounded(scalar)
    k = {c.name: c.value for c in block.constants}
    on_eta = [k[f"k_{s.name}"] for s in block.states]
    return readonly([[k["k_e"], k["k_de"], *np.linalg.solve(T.T, on_eta)]])


@dataclass(frozen=True, eq=False)
class Recorded:
    """A run's controller inputs (N,) by name, and what the C answered."""

    inputs: Mapping[str, Any]
    outputs: Mapping[str, Any]
    faults: Any


def _recorded(plant: Plant, controller: host.Controller) -> Recorded:
    """Return a lift-off from the stop with moves in x, z and theta, three bad encoder samples and a bad set-point."""
    time = sample_times(STEPS * control.TIME.period_s, control.TIME.period_s)
    wave = np.sin(control.OMEGA0 * time)
    references = {
        "y_ref": 0.031 - 0.006 * time,
        "x_ref": 0.005 * wave,
        "z_ref": -0.005 * wave,
        "theta_ref": 0.001 * wave,
    }
    references["y_ref"][BAD_SET_POINT] = 0.05
    mask = np.zeros(STEPS, dtype=bool)
    mask[BAD] = True
    bad = Override(mask, np.full(STEPS, 0.2))
    run = Loop(plant, controller).run(time[-1] + control.TIME.period_s, {"y": 0.031}, references, overrides={"x": bad})
    inputs = dict(run.measured)
    replay = controller.replay(inputs)
    return Recorded(inputs, replay.outputs, replay.faults)
