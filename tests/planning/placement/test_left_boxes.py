"""How searches end early: boxes left are looked at once or twice, in little memory, and fingers slide on."""

import tracemalloc

import numpy as np
import pytest

import regrasp as rg
from placements import star
from regrasp.planning.placement import choosing
from regrasp.planning.placement.levels.climbing import first_that_excludes, outward
from regrasp.planning.placement.proofs.box_rows import strongest

pytestmark = pytest.mark.laws

AIM, TOP = 1.0, 3.0


def settled(needed: np.ndarray) -> tuple[float, bool, np.ndarray, float]:
    """The level reached, whether it excludes boxes that need these, the last looks' levels, looks a box."""
    at, looks, last = [0.0], [0], np.zeros(len(needed))

    def excluded(boxes: np.ndarray) -> int:
        for number, box in enumerate(boxes):
            looks[0] += 1
            last[box] = at[0]
            if needed[box] > at[0]:
                return number
        return len(boxes)

    levels = outward(AIM, TOP, [1.7])
    reached, closed = first_that_excludes(
        levels, np.arange(len(needed)), lambda level: at.__setitem__(0, level), excluded
    )
    assert looks[0] <= 2 * len(needed) + len(levels)
    return reached, closed, last, looks[0]


@pytest.mark.parametrize("order", ["rising", "falling", "random"])
def test_the_first_level_that_does_is_reached(order: str) -> None:
    needed = np.sort(np.random.default_rng(3).uniform(AIM, 2.1, 500))
    needed = {"rising": needed, "falling": needed[::-1]}.get(
        order, np.random.default_rng(4).permutation(needed)
    )
    reached, closed, last, _ = settled(needed)
    assert closed
    assert reached == min(level for level in outward(AIM, TOP, [1.7]) if level >= needed.max())
    assert (last == reached).all()  # so that what excludes each is of that level


def test_a_level_that_was_closed_before_is_reached() -> None:
    assert settled(np.array([1.6, 1.69]))[:2] == (1.7, True)


def test_at_the_aim_nothing_is_looked_at_twice() -> None:
    assert settled(np.full(50, AIM))[::3] == (AIM, 50)


def test_where_one_is_not_excluded_at_the_top_none_is_said_to_be() -> None:
    assert settled(np.array([1.2, 5.0, 1.1]))[:2] == (TOP, False)


def test_without_boxes_the_aim_is_reached() -> None:
    assert settled(np.zeros(0))[:2] == (AIM, True)


def test_loads_of_twists_take_little_memory() -> None:
    rng = np.random.default_rng(5)
    twists, loads = rng.normal(size=(20_000, 3)), rng.normal(size=(500, 3))
    tracemalloc.start()
    found = strongest(twists, loads)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 0.25 * 8 * len(twists) * len(loads)
    some = slice(None, None, 400)
    assert (found[some] == (-twists[some] @ loads.T).argmax(axis=1)).all()
    assert strongest(twists[:0], loads).shape == (0,)


def test_what_a_search_cut_short_found_slides_to_where_it_is_better(monkeypatch: pytest.MonkeyPatch) -> None:
    angle = np.arange(12) * np.pi / 6
    loads = np.column_stack([np.cos(angle), np.sin(angle), 0.1 * np.cos(3 * angle)])

    def chosen() -> rg.ChosenGrasp:
        every = rg.LoadSet.hull(map(rg.Wrench.from_vector, loads))
        return rg.choose_grasp(
            star(3, 40), 3, every, friction=0.4, objective="peak", most_boxes=64, tolerance=1e-6
        )

    better = chosen()
    monkeypatch.setattr(choosing, "slide_best", lambda *_: None)
    assert better.value < 0.998 * chosen().value
    assert better.bound == chosen().bound
    assert rg.verify(better).ok
