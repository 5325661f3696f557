"""Memory of loops in lanes: alignment, and that it serves again only once no array needs it."""

import numpy as np
import pytest

from synth.simulate.lanes import lane_blocks

LONG = lane_blocks.LARGE // 4  # doubles: more than a large page


@pytest.fixture(autouse=True)
def pages(monkeypatch: pytest.MonkeyPatch) -> None:
    """No page of an earlier run is free."""
    monkeypatch.setattr(lane_blocks, "_PAGES", type(lane_blocks._PAGES)())


def test_arrays_start_where_vectors_need_it() -> None:
    for n in (1, 7, LONG):
        assert lane_blocks.zeros((n, 8), np.float64).ctypes.data % lane_blocks.ALIGNMENT == 0
        assert not lane_blocks.zeros((n, 8), np.float32).any()


def test_memory_serves_again_only_after_the_last_view_of_it() -> None:
    array = lane_blocks.empty((LONG,), np.float64)
    array[:] = 1.0
    address, view = array.ctypes.data, array.reshape(2, -1)[1]
    del array
    other = lane_blocks.empty((LONG,), np.float64)
    other[:] = 2.0
    assert other.ctypes.data != address and (view == 1.0).all()
    del view
    assert lane_blocks.empty((LONG,), np.float64).ctypes.data == address
    assert not lane_blocks.zeros((LONG,), np.float64).any(), "also in memory with values of another run"


def test_no_more_memory_is_kept_than_allowed() -> None:
    pages = lane_blocks._PAGES
    arrays = [lane_blocks.empty((lane_blocks.KEPT // 32,), np.float64) for _ in range(6)]
    del arrays
    assert 0 < sum(map(len, pages._free)) <= lane_blocks.KEPT
