"""Bisection of claims with known truth: proofs, failing points, zero crossings, whole numbers, and the budget."""

from collections.abc import Callable

import numpy as np
import pytest

from synth.emit.proof import bisection
from synth.emit.proof.bisection import Judgement
from synth.emit.proof.interval import Array, Interval


def judge(f: Callable[..., Array], slope: float = 1.0, log: list[int] | None = None) -> bisection.Judge:
    """Judge f > 0 on cells; f is monotone in each coordinate, and enclosures are too wide by `slope` times the cell."""

    def of(low: Array, high: Array, exact: bool) -> Judgement:
        corners = np.stack(np.meshgrid(*([0, 1] * 1 for _ in low), indexing="ij"), -1).reshape(-1, len(low))
        values = np.stack([f(*np.where(c[:, None] == 1, high, low)) for c in corners])
        width = 0 if exact else slope * (high - low).max(axis=0)
        a = Interval(values.min(axis=0) - width, values.max(axis=0) + width, np.zeros(low.shape[1], bool))
        if log is not None and not exact:
            log.append(low.shape[1])
        return Judgement(a.low > 0, a.high <= 0, (a.low + a.high) / 2, {7: a})

    return of


def box(*sides: tuple[float, float], whole: bool = False) -> tuple[Array, Array, Array]:
    low, high = np.array(sides, np.float64).T
    return low, high, np.full(len(sides), whole)


def test_a_claim_that_holds_is_proved_and_the_hull_is_that_of_its_cells() -> None:
    verdict = bisection.prove(*box((0, 1), (0, 1)), judge(lambda x, y: 0.1 + x + y), False)
    assert verdict.proved and verdict.cells > 10
    assert 0 < verdict.hull[7].low[0] <= 0.1 and 2.1 <= verdict.hull[7].high[0] < 3.2


def test_a_claim_that_fails_somewhere_gives_a_point() -> None:
    verdict = bisection.prove(*box((0, 1), (0, 1)), judge(lambda x, y: x + y - 0.01), False)
    assert verdict.fails and not verdict.proved and verdict.point.sum() <= 0.01
    inside = bisection.prove(*box((-1, 2), (-1, 2)), judge(lambda x, y: np.maximum(x, y) - 0.3 + 0 * x), False)
    assert inside.fails and inside.point.max() <= 0.3


def test_a_zero_crossing_is_distinguished_from_a_jump() -> None:
    def never_fails(low: Array, high: Array, exact: bool) -> Judgement:
        verdict = judge(lambda x: x - 0.3, 0.0)(low, high, exact)
        a = verdict.watched[7]
        return Judgement((a.low > 0) | (a.high < 0), np.zeros_like(verdict.fails), verdict.value, verdict.watched)

    verdict = bisection.prove(*box((-1, 2)), never_fails, True)
    assert verdict.fails != verdict.crosses  # whether 0.3 is a middle of a cell
    assert verdict.point[0] == pytest.approx(0.3, abs=1e-15)
    other = bisection.prove(*box((-1, 2)), never_fails, False, 1000)
    assert not (other.fails or other.crosses)  # sought where one sign is asked for only


@pytest.mark.parametrize(
    ("below", "above", "slope"), [(-1.5, 2.5, 0), (-1e-6, 1, 0), (-1e-9, 1e-9, 0), (-1, 1e-9, 1), (-1e-3, 1e-3, 2)]
)
def test_a_jump_over_zero_is_no_crossing(below: float, above: float, slope: float) -> None:
    def jumps(low: Array, high: Array, exact: bool) -> Judgement:
        a = judge(lambda x: x - 0.3, 0.0)(low, high, exact).watched[7]
        holds = (a.low > 0) | (a.high < 0)
        middle = (a.low + a.high) / 2
        value = np.where(middle > 0, above, below) + slope * middle
        return Judgement(holds, np.zeros_like(holds), value, {7: a})

    verdict = bisection.prove(*box((-1, 2)), jumps, True, 1000)
    assert not (verdict.fails or verdict.crosses)


def test_whole_numbers_are_not_split_further() -> None:
    def away(low: Array, high: Array, exact: bool) -> Judgement:
        a = judge(lambda n: n - 4.5, 0.0)(low, high, exact).watched[7]
        return Judgement((a.low > 0) | (a.high < 0), np.zeros_like(a.nan), (a.low + a.high) / 2, {7: a})

    assert bisection.prove(*box((0, 9), whole=True), away, False).proved  # 4.5 alone fails, and is not whole
    assert not bisection.prove(*box((0, 9)), away, False, 500).proved


def test_the_budget_is_respected_and_the_open_cell_reported() -> None:
    log: list[int] = []
    verdict = bisection.prove(*box((0, 1), (0, 1)), judge(lambda x, y: x + y, 1.0, log), False, 300)
    assert not verdict.proved and verdict.cells == sum(log[1:]) <= 300  # the first call weighs the sides
    assert bisection.prove(*box((0, 1)), judge(lambda x: x + 1, 100.0), False, 10).cells == 7  # 1 + 2 + 4, then 8 more
    assert (verdict.low <= verdict.point).all() and (verdict.point <= verdict.high).all() and verdict.high.max() < 1


def test_the_most_influential_side_is_halved_first() -> None:
    cells: dict[bool, int] = {}
    for swapped in (False, True):
        f: Callable[..., Array] = (lambda y, x: 0.05 + x + 1e-6 * y) if swapped else (lambda x, y: 0.05 + x + 1e-6 * y)

        def of(low: Array, high: Array, exact: bool, f: Callable[..., Array] = f, swapped: bool = swapped) -> Judgement:
            wide = 0 if exact else (high - low)[1 if swapped else 0]  # only this side costs
            a = judge(f, 0.0)(low, high, exact).watched[7]
            a = Interval(a.low - wide, a.high + wide, a.nan)
            return Judgement(a.low > 0, a.high <= 0, (a.low + a.high) / 2, {7: a})

        verdict = bisection.prove(*box((0, 1), (0, 1)), of, False)
        cells[swapped] = verdict.cells
        assert verdict.proved
    assert cells[False] == cells[True] < 20
