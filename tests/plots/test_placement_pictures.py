"""Pictures of chosen grasps and of regions say where fingers are and what is proven."""

import pytest

import regrasp as rg
from regrasp import plots
from values import SQUARE_OUTLINE, WEIGHT_IN_PLANE, placed

pytestmark = pytest.mark.contract


def test_a_chosen_grasp_shows_fingers_others_and_both_numbers() -> None:
    ax = plots.plot_chosen_grasp(placed(), units=plots.Units("mm", "N", "s"))
    ids = [artist.get_gid() for artist in (*ax.lines, *ax.patches)]
    assert ids.count("contact") == ids.count("cone") == 2
    assert ids.count("other") == len(placed().others)
    words = ax.get_legend().get_texts()[0].get_text()
    assert words.startswith("sum_normal 2.001, bound 2 N")
    assert ax.get_xlabel() == "$x$ [mm]"


def test_regions_are_drawn_where_they_are() -> None:
    regions = rg.contact_regions(SQUARE_OUTLINE, placed().grasp, WEIGHT_IN_PLANE)
    ax = plots.plot_contact_regions(regions)
    drawn = [line.get_xydata() for line in ax.lines if line.get_gid() == "region"]
    assert len(drawn) == 2
    for line, arc in zip(drawn, regions.arcs, strict=True):
        assert line == pytest.approx(SQUARE_OUTLINE.points(arc))
    assert " m at once" in ax.get_legend().get_texts()[0].get_text()
