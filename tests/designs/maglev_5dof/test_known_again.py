"""Phase currents once a position is known again: what has faded out fades in."""

import json
from pathlib import Path

import numpy as np

from designs.maglev import commutation
from synth.execute import host

NAME = "maglev_5dof_phase"
FOLDER = Path(__file__).parents[3] / "generated_c" / NAME
LOST, AGAIN, SAMPLES = 10, 300, 400  # samples


def largest_step(source: str) -> float:
    """Return the largest change of a phase current in A from one sample to the next, x and z lost for 290 samples."""
    files = {path.name: path.read_text() for path in FOLDER.glob("*.[ch]")} | {f"{NAME}.c": source}
    controller = host.load(files, json.loads((FOLDER / "manifest.json").read_text()))
    k = np.arange(SAMPLES)
    lost, inputs = np.where((k >= LOST) & (k < AGAIN), 0.2, 0.01), {}
    for name in (f["name"] for f in controller.manifest["structs"]["input"]["fields"]):
        inputs[name] = np.full(SAMPLES, 2.5 if "i_d" in name else 0.0) if name.startswith("i_") else lost
    outputs = controller.replay(inputs).outputs
    return max(float(np.abs(np.diff(column)).max()) for column in outputs.values())


def test_currents_fade_in_when_a_position_is_known_again() -> None:
    assert 0.1 < largest_step((FOLDER / f"{NAME}.c").read_text()) < 2 * 2.5 * np.sqrt(2) / commutation.FADE
