"""How far apart placements are: the shorter way around, of the worst finger, to the nearest image."""

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.placement.results import _apart

pytestmark = pytest.mark.contract


def test_the_way_is_the_shorter_one_around_of_the_finger_that_has_the_longest_to_the_nearest() -> None:
    """Of an outline of length 10."""
    one = np.array([[0.5, 5.0], [1.0, 4.0]])
    for others, ways in (
        ([[9.8, 5.2]], [0.7, 1.2]),  # past the first vertex
        ([[0.5, 9.9]], [4.9, 4.1]),
        ([[0.5, 9.9], [9.8, 5.2]], [0.7, 1.2]),  # to the nearest
        ([[0.5, 5.0]], [0.0, 1.0]),
    ):
        np.testing.assert_allclose(_apart(one, np.array(others), 10.0), ways, atol=1e-12)


@pytest.mark.parametrize("fingers", [2, 3])
def test_others_are_a_twentieth_away_from_all_that_is_alike(fingers: int) -> None:
    """On a square a mirror takes each placement to one as good, which is none of the others."""
    square = rg.Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
    loads = [rg.Wrench([way * 0.3, -1]) for way in (1, -1)] + [
        rg.Wrench([0, 0.5], 0.2 * way) for way in (1, -1)
    ]
    chosen = rg.choose_grasp(square, fingers, rg.LoadSet.hull(loads), friction=0.4, objective="peak")
    kept = [chosen.places]
    assert chosen.others
    for other in chosen.others:
        for places in kept:
            for image in (places, (2.0 - places) % 8):
                for turn in range(fingers):
                    away = np.abs(other.places - np.roll(np.sort(image), turn))
                    assert np.minimum(away, 8 - away).max() >= 0.05 * 8 * (1 - 1e-9)
        kept.append(other.places)
