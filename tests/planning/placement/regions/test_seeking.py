"""Boxes sought with few questions: against the largest that there are, where these are known."""

import numpy as np
import pytest

from regrasp.mechanics.checks import Array
from regrasp.planning.placement.regions.seeking import Seeking

pytestmark = pytest.mark.laws


def score(ways: Array) -> float:
    return float(np.log(ways[::2] + ways[1::2]).sum())


def test_the_least_arc_is_nearly_the_longest() -> None:
    """Ways b, a back and ahead with b <= 1 on one side: widths of 5 in all, from places askew."""
    asked = []

    def holds(ways: Array) -> bool:
        asked.append(ways)
        return ways[0] <= 0.5 and ways[3] <= 0.3 and ways.sum() <= 5.0

    start = np.full(4, 0.3)
    found = Seeking(holds, np.full(4, 9.0), 80).least(start)
    assert holds(found)
    assert (found >= 0).all()
    assert np.allclose(found[::2] + found[1::2], found[0] + found[1])
    assert 2.2 < found[0] + found[1] <= 2.5
    assert len(asked) <= 80


def test_the_product_is_nearly_the_largest() -> None:
    """Where 3 of one width counts as much as 1 of another the best has 3 of the sum in each."""

    def holds(ways: Array) -> bool:
        return bool((ways[:2].sum() + 3 * ways[2:].sum()) <= 6.0)

    start = np.array([0.6, 0.6, 0.8, 0.8])
    found = Seeking(holds, np.full(4, 9.0), 80).product(start, score)
    assert holds(found)
    assert score(found) > score(start) + 0.3
    assert score(found) > np.log(0.97 * 3.0 * 1.0)


def test_nothing_is_asked_twice_or_beyond_the_longest_and_what_holds_stays() -> None:
    refused: list[Array] = []

    def holds(ways: Array) -> bool:
        assert not any((ways >= r).all() for r in refused)
        assert (ways <= 1.2).all()
        refused.append(ways)
        return False

    start = np.array([1.0, 1.0, 0.9, 0.8])
    assert Seeking(holds, np.full(4, 1.2), 80).product(start, score).tolist() == start.tolist()
    few = Seeking(holds, np.full(4, 1.2), 3)
    refused.clear()
    few.product(start, score)
    assert len(refused) == 3
    refused.clear()
    least = Seeking(holds, np.full(4, 1.2), 80).least(start)
    assert least[0] + least[1] == least[2] + least[3] == pytest.approx(1.7)
    assert (least <= start + 1e-12).all()
