"""The committed C answers its test vectors, and its gains are those of the paper."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from designs.maglev_5dof import reference, reference_gains
from designs.maglev_5dof.design import DESIGN
from synth.app import standard_tasks
from synth.emit.write import EmittedCode

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def regenerated() -> Mapping[str, EmittedCode]:
    return standard_tasks.emit(DESIGN, np.float32)


def test_gains_ship_the_published_weights_and_their_certificate() -> None:
    gains = json.loads((ROOT / "generated_c/maglev_5dof/gains.json").read_text())
    y = gains["design"]["y"]
    assert y["K"] == [float(np.float32(v)) for v in y["K"]]
    np.testing.assert_allclose(y["K"], [-1699.7, -182.75, -50000, 2725.5, -7806.8], rtol=3e-5)
    assert y["certificate"]["relative_forward_error_estimate"] < 1e-15
    assert not gains["design"]["phi"]["published_weights"]
    assert gains["constants"]["regulator_y_k_e"]["value"] == y["K"][0]


def test_the_constants_are_the_gains_in_the_coordinates_of_the_loop(regenerated: Mapping[str, EmittedCode]) -> None:
    """K on (e, de, xi) and xi = T eta: the constants on eta are K T, rounded once to single precision."""
    gains = json.loads(regenerated["maglev_5dof"].files["gains.json"])
    for axis, document in gains["design"].items():
        shipped = [gains["constants"][f"regulator_{axis}_k_{s}"]["value"] for s in ("e", "de", "sum", "p1", "q1")]
        exact = np.array(reference_gains.gain(reference.WEIGHTS[axis]))
        exact[2:] = exact[2:] @ np.array(document["T"])
        np.testing.assert_allclose(shipped, exact, rtol=2.0**-24 * 1.001)
        assert shipped == [float(np.float32(v)) for v in shipped]
        assert 1 <= document["sampled_data_optimum"]["worst_cost_ratio_of_K"] < 2
        moved = np.roll(np.array(document["T"]), 1, axis=1)
        assert not np.allclose(shipped[2:], np.array(document["K"])[2:] @ moved, rtol=1e-3)
