"""Why there is no grasp, in whole sentences: whether it is proven, what is needed, and what would help."""

import re

import numpy as np
import pytest

import regrasp as rg
from placements import BRACKET, TILTED
from regrasp.planning.placement import results
from regrasp.planning.placement.search import Search

pytestmark = pytest.mark.contract

SLIVER = rg.Outline([[0, 0], [10, 0], [5, 1e-2]])
SQUARE = rg.Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
TRIANGLE = rg.Outline([[0, 0], [2, 0], [1, 1.7]])
DOWN = rg.Wrench([0, -1])
STEEP = rg.LoadSet.hull([rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1]), rg.Wrench([0, -1], 0.1)])
SLOPES = rg.LoadSet.hull([rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1])])
NEVER = {"keep": lambda p, q, angle: np.zeros(len(p), bool)}
EVERYWHERE = {"from_corners": 0.0}
NARROW = {"friction": 1e-5, "max_force": 1e4, "most_boxes": 64, **EVERYWHERE}
NONE_FOUND = "no 3 fingers anywhere on this outline were found to hold the loads, with friction 1e-05 and "
OPEN = "it is not proven that there are none: allow more by most_boxes"


def refused(shape, fingers, load, **asked) -> tuple[str, float]:
    """Its words, with what the proof says in the place of {}, and that."""
    with pytest.raises(rg.Infeasible) as none:
        rg.choose_grasp(shape, fingers, load, **asked)
    proof = none.value.certificate
    assert rg.verify(proof).ok
    return str(none.value), proof.bound


@pytest.mark.parametrize(
    ("shape", "fingers", "load", "asked", "words"),
    [
        (
            BRACKET, 3, TILTED, {"friction": 0.02, "max_force": 0.3},
            "no 3 fingers anywhere on this outline hold the loads, with friction 0.02 and forces of at most "
            "0.3 N",
        ),
        (
            BRACKET, 2, TILTED,
            {"friction": 0.05, "arcs": [[0, 1.4]], "min_distance": 1.0, "max_force": 5.0, "min_normal": 0.1},
            "no 2 fingers anywhere on the 9.9% of this outline where they may be, 1 m apart, hold the loads, "
            "with friction 0.05 and forces of at most 5 N, each finger pushing with 0.1 N or more",
        ),
        (
            SQUARE, 2, DOWN, {"friction": 0.0, "from_corners": 0.0, "arcs": [[2.1, 3.9], [6.1, 7.9]]},
            "no 2 fingers anywhere on the 45.0% of this outline where they may be hold the loads, with "
            "friction 0, not by forces of {:.3g} N either",
        ),
        (
            BRACKET, 2, TILTED, {"friction": 0.4, "objective": "angle", "max_force": 0.3},
            "no 2 fingers anywhere on this outline hold the loads, with friction 0.4 and forces of at most "
            "0.3 N",
        ),
        (
            SLIVER, 3, STEEP, {"objective": "friction_use", **NARROW},
            f"{NONE_FOUND}forces of at most 10000 N, and forces of {{:.6g}} N are needed at the least; "
            f"friction_use is nowhere better than 0; {OPEN}",
        ),
        (
            SLIVER, 3, STEEP, {"objective": "force", **NARROW},
            f"{NONE_FOUND}forces of at most 10000 N; force is nowhere better than 0.1; {OPEN}",
        ),
        (
            BRACKET, 2, TILTED, {"friction": 0.4, "most_boxes": 64, **NEVER},
            "no placement was found that holds the loads and keeps the constraints; without them none needs "
            "less than {:.6g} N, and that there is none with them is not proven: 2047 boxes were looked at, "
            "allow more by most_boxes",
        ),
        (
            TRIANGLE, 2, SLOPES, {"friction": 0.29999, "most_boxes": 64},
            "placements that hold the loads are so few that rounding decides, and none of those tried has "
            "forces inside the cones; none needs less than {:.6g} N (with friction 0.30009 one does hold "
            "them, sum_normal 1)",
        ),
        *(
            (
                TRIANGLE, 2, SLOPES, {"friction": 0.29999999, "max_force": 5.0, **EVERYWHERE, **more},
                "no 2 fingers anywhere on this outline hold the loads, with friction 0.29999999 and forces "
                "of at most 5 N",
            )
            for more in ({}, {"objective": "force"})
        ),
    ],
)  # fmt: skip
def test_words_of(shape, fingers, load, asked, words) -> None:
    said, bound = refused(shape, fingers, load, **asked)
    assert said == words.format(bound)


def test_a_level_that_rounding_decides_is_not_proven_to_be_none(monkeypatch) -> None:
    monkeypatch.setattr(results, "_ATTEMPTS", 2)
    words, bound = refused(
        TRIANGLE, 2, SLOPES, friction=0.3, objective="friction_use", max_force=5.0, most_boxes=64,
        **EVERYWHERE,
    )  # fmt: skip
    assert bound == np.nextafter(5, 6)
    assert words == (
        "placements that hold the loads are so few that rounding decides, and none of those tried has "
        "forces inside the cones and the limit; friction_use is nowhere better than 0.9991"
    )


def test_what_is_left_too_narrow_is_on_a_knifes_edge(monkeypatch) -> None:
    def closed(search: Search, *_: object, **__: object) -> bool:
        search.closed, search.narrow = True, 0.0
        return False

    monkeypatch.setattr(Search, "goes_on", closed)
    assert refused(SQUARE, 2, rg.LoadSet.hull([DOWN, rg.Wrench([0, 1])]), friction=0.0) == (
        "no placement was found that holds the loads, and none needs less than 0 N; it is not proven that "
        "there is none: what is left is too narrow to be split, on a knife's edge",
        0.0,
    )


@pytest.mark.parametrize(("apart", "said"), [(0.01413, False), (0.01 * np.hypot(1, 1), True)])
def test_a_distance_is_told_from_a_hundredth_of_the_size_on(apart, said) -> None:
    """The corners are root of two away."""
    words, _ = refused(SQUARE, 2, DOWN, friction=0.0, max_force=0.1, min_distance=apart)
    assert ("m apart" in words) == said


@pytest.mark.parametrize(("away", "said"), [(0.099, False), (0.101, True)])
def test_a_share_is_told_up_to_nine_tenths(away, said) -> None:
    words, _ = refused(SQUARE, 2, DOWN, friction=0.0, max_force=0.1, from_corners=away)
    assert (re.search(r"the 8\d\.\d% of this outline", words) is not None) == said


def test_no_more_friction_is_tried_after_an_interrupt() -> None:
    def interrupted(*_: float) -> None:
        raise KeyboardInterrupt

    words, _ = refused(TRIANGLE, 2, SLOPES, friction=0.29999, most_boxes=64, progress=interrupted)
    assert words.endswith(" N")
