"""Margins of transfer functions as their coefficients determine them."""

import control
import numpy as np
import pytest

from synth.analyse.loops import stability_margins
from synth.errors import ModelError
from tests.analyse.scalar_loops import EXACT


def fraction(b: list[str], a: list[str], period: float) -> object:
    """A sampled transfer function from coefficients to the last bit, which rounding of a conversion does not decide."""
    return control.tf([float.fromhex(v) for v in b], [float.fromhex(v) for v in a], period)


MAGLEV_50_US = fraction(
    [
        "0x1.102fbaca78d89p-31",
        "0x1.5098b1a60d65cp-28",
        "-0x1.ad62ec8d66a00p-35",
        "-0x1.4da77277088dep-28",
        "-0x1.081019c4be83bp-31",
    ],
    [
        "0x1.0p+0",
        "-0x1.3cd5bfbbb559bp+2",
        "0x1.39b11e5295500p+3",
        "-0x1.369215bca0312p+3",
        "0x1.33789ff1189b5p+2",
        "-0x1.e7078b0a726acp-1",
    ],
    5e-5,
)
MAGLEV_10_US = fraction(
    [
        "0x1.c1794ab273059p-41",
        "0x1.1851412c591b0p-37",
        "-0x1.1f15769b1ac00p-46",
        "-0x1.17d3598cc39f8p-37",
        "-0x1.bec21d7701148p-41",
    ],
    [
        "0x1.0p+0",
        "-0x1.3f5c853d92358p+2",
        "0x1.3eb944e622294p+3",
        "-0x1.3e163eed14c69p+3",
        "0x1.3d737345ceaa2p+2",
        "-0x1.fae7cfd2b9d04p-1",
    ],
    1e-5,
)
LAGS_30_US = fraction(
    ["0x1.3717333333334p-51", "0x1.ab7ae64af12f9p-48", "0x1.ab33d25bb23fcp-48", "0x1.36836474925e0p-51"],
    ["0x1.0p+0", "-0x1.ff97e5f966cb0p+1", "0x1.7f63e145ff2b4p+2", "-0x1.fec7d32b329c2p+1", "0x1.fe5fda626c460p-1"],
    3e-5,
)
LAGS_20_US = fraction(
    ["0x1.ebacccccccccdp-54", "0x1.51e897fc0c4fdp-50", "0x1.51c1962169ba0p-50", "0x1.eb1941154cbc0p-54"],
    ["0x1.0p+0", "-0x1.ffba9398ec16ap+1", "0x1.7f97e1178ce7ep+2", "-0x1.ff2fc99342fbap+1", "0x1.feea6bf4550afp-1"],
    2e-5,
)


@pytest.mark.parametrize(
    ("L", "gain", "low"),
    [(MAGLEV_50_US, 2.75960792, 0.33343903), (LAGS_30_US, 12.07982262, 0.0)],
    ids=["maglev", "lags"],
)
def test_a_fast_sampled_transfer_function_keeps_its_gain_margin(L: object, gain: float, low: float) -> None:
    """Its poles cluster at z = 1; the margins are those of the coefficients, from roots in 60 digits."""
    loop_margins = stability_margins.of_loop(L)
    assert loop_margins.stable and loop_margins.gain_margin == pytest.approx(gain, rel=1e-7)
    assert loop_margins.gain_reduction_margin == pytest.approx(low, rel=1e-7)
    assert (
        1e-4 < loop_margins.uncertainty < stability_margins.MAX_UNCERTAINTY
        and "makes the margins uncertain by" in repr(loop_margins)
    )


@pytest.mark.parametrize("L", [MAGLEV_10_US, LAGS_20_US], ids=["maglev", "lags"])
def test_coefficients_that_no_longer_determine_a_margin_are_refused(L: object) -> None:
    with pytest.raises(ModelError, match=r"(not determined by the coefficients|hides whether).*loop\.sampled"):
        stability_margins.of_loop(L)


def test_the_crossing_at_zero_frequency_of_a_transfer_function_is_kept() -> None:
    s = control.tf("s")
    L = 400 / (s**2 - 400) / (1 + s / 1000) ** 3 * 3 * (1 + s / 15) / (1 + s / 1000)
    loop_margins = stability_margins.of_loop(L)
    assert (
        loop_margins.gain_reduction_margin == pytest.approx(1 / 3, rel=EXACT)
        and loop_margins.phase_crossings[0].frequency == 0
    )
    T = 1e-3
    a = np.poly(np.exp(np.array([20.0, -20.0]) * T))
    sampled = control.tf([3 * abs(a.sum())], a, T)  # -3 at z = 1
    assert stability_margins.of_loop(sampled).gain_reduction_margin == pytest.approx(1 / 3, rel=1e-6)
