"""Pictures of chosen grasps and of regions say where fingers are and what is proven."""

import numpy as np
import pytest

import regrasp as rg
from regrasp import plots
from values import SQUARE_OUTLINE, WEIGHT_IN_PLANE, mapped, on_faces, placed

pytestmark = pytest.mark.contract


def test_a_chosen_grasp_shows_fingers_others_and_both_numbers() -> None:
    ax = plots.plot_chosen_grasp(placed(), units=plots.Units("mm", "N", "s"))
    ids = [artist.get_gid() for artist in (*ax.lines, *ax.patches)]
    assert ids.count("contact") == ids.count("cone") == 2
    assert ids.count("other") == len(placed().others)
    words = ax.get_legend().get_texts()[0].get_text()
    assert words.startswith("sum_normal 2.001, bound 2 N")
    assert ax.get_xlabel() == "$x$ [mm]"


def test_a_chosen_grasp_on_a_mesh_shows_the_same() -> None:
    box = rg.Mesh.box(0.04, 0.03, 0.05)
    found = rg.choose_grasp(box, 3, rg.Wrench([0, 0, -2]), friction=0.5, objective="peak", tolerance=0.1)
    ax = plots.plot_chosen_grasp(found)
    ids = [artist.get_gid() for artist in ax.lines]
    assert [name in ids for name in ("contact F1", "contact F2", "contact F3")] == [True] * 3
    assert ids.count("other") == 3 * len(found.others)
    assert ax.get_legend().get_texts()[0].get_text().startswith("peak ")


def test_regions_are_drawn_where_they_are() -> None:
    regions = rg.contact_regions(SQUARE_OUTLINE, placed().grasp, WEIGHT_IN_PLANE)
    ax = plots.plot_contact_regions(regions)
    drawn = [line.get_xydata() for line in ax.lines if line.get_gid() == "region"]
    assert len(drawn) == 2
    for line, arc in zip(drawn, regions.arcs, strict=True):
        assert line == pytest.approx(SQUARE_OUTLINE.points(arc))
    alone = [line.get_xydata() for line in ax.lines if line.get_gid() == "alone"]
    for line, place, off in zip(alone, regions.places, regions.alone, strict=True):
        assert line == pytest.approx(SQUARE_OUTLINE.points(place + off * [-1, 1]))
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert [word.split()[0] for word in words[:2]] == list(regions.grasp.names)
    assert " m at once" in words[2]
    assert words[3] == "one finger alone"


def test_of_regions_on_one_side_the_narrower_lies_above() -> None:
    bracket = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
    below = rg.Grasp(bracket.contact_at(s, friction=0.4) for s in (0.02, 0.5, 3.98))
    regions = rg.contact_regions(bracket, below, rg.Wrench([0, -1]))
    ax = plots.plot_contact_regions(regions)
    above = {
        line.get_zorder(): np.ptp(line.get_xydata()[:, 0]) for line in ax.lines if line.get_gid() == "region"
    }
    assert len(above) == 3
    assert [above[order] for order in sorted(above)] == pytest.approx(sorted(regions.widths, reverse=True))


def test_maps_show_values_where_fingers_hold_and_a_ring_at_the_best() -> None:
    found = rg.placement_map(SQUARE_OUTLINE, WEIGHT_IN_PLANE, friction=0.5, count=16)
    ax = plots.plot_placement_map(found, units=plots.Units("mm", "N", "s"))
    drawn = {artist.get_gid(): artist for artist in (*ax.collections, *ax.lines)}
    assert drawn["values"].get_array().count() == (~np.isnan(found.values)).sum()
    assert drawn["best"].get_xydata()[0] == pytest.approx(found.at)
    assert [axes.get_ylabel() for axes in ax.figure.axes[1:]] == ["sum normal [N]"]
    assert ax.get_xlabel() == "one finger at arc length [mm]"
    ax = plots.plot_placement_outline(found)
    parts = {c.get_gid(): len(c.get_paths()) for c in ax.collections}
    assert parts["best"] == (~np.isnan(found.best)).sum()
    assert parts["best"] + parts["no hold"] == len(found.places)


@pytest.mark.parametrize(("objective", "times"), [("peak", 5), ("effort", 25)])
def test_forces_of_maps_that_grow_without_end_have_one_colour_beyond_some_times_the_best(
    objective: str, times: float
) -> None:
    found = rg.placement_map(SQUARE_OUTLINE, WEIGHT_IN_PLANE, friction=0.5, objective=objective, count=40)
    least = np.nanmin(found.values)
    assert np.nanmax(found.values) > 10 * times * least
    ax = plots.plot_placement_map(found)
    drawn = next(artist for artist in ax.collections if artist.get_gid() == "values")
    colour = drawn.to_rgba
    assert drawn.norm.vmax == pytest.approx(times * least)
    assert (colour([1.01 * times * least]) == colour([1e6 * least])).all()
    assert (colour([0.9 * times * least]) != colour([1e6 * least])).any()
    assert (colour([least]) != colour([1.1 * least])).any()
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    assert words == [f"no hold: {1 - found.share:.0%}", f"over {times} times the best"]


def test_shares_of_friction_and_what_is_largest_at_best_are_told_apart_to_the_last() -> None:
    for objective in ("friction_use", "angle"):
        found = rg.placement_map(
            SQUARE_OUTLINE, WEIGHT_IN_PLANE, friction=0.5, objective=objective, max_force=30.0, count=20
        )
        ax = plots.plot_placement_map(found)
        norm = next(artist for artist in ax.collections if artist.get_gid() == "values").norm
        most = np.nanmax(found.values)
        assert norm.vmax == pytest.approx(np.degrees(most) if objective == "angle" else most)
        assert [text.get_text()[:7] for text in ax.get_legend().get_texts()] == ["no hold"]


@pytest.mark.parametrize("shape", [SQUARE_OUTLINE, rg.Outline.ellipse(0.2, 0.1)], ids=["square", "ellipse"])
def test_regions_of_two_fingers_are_a_box_on_their_map_either_way_around(shape: rg.Outline) -> None:
    """On the ellipse one arc runs past the first vertex: its box is drawn at both ends."""
    pair = [shape.contact_at(f * shape.length, friction=0.5, name=str(f)) for f in (0.02, 0.52)]
    if shape is SQUARE_OUTLINE:
        pair = list(placed().grasp)
    regions = rg.contact_regions(shape, rg.Grasp(pair), WEIGHT_IN_PLANE)
    found = rg.placement_map(shape, WEIGHT_IN_PLANE, friction=0.5, count=12)
    ax = plots.plot_placement_map(found, regions=regions)
    boxes = [p for p in ax.patches if p.get_gid() == "region"]
    corners = {
        tuple(np.round([box.get_xy(), np.add(box.get_xy(), (box.get_width(), box.get_height()))], 9).ravel())
        for box in boxes
    }
    (a, b), (c, d) = regions.arcs.round(9)
    for x, y, right, top in ((a, c, b, d), (c, a, d, b)):
        assert (x, y, right, top) in corners
    past = (regions.arcs < 0).any() or (regions.arcs > shape.length).any()
    assert len(corners) == (4 if past else 2)
    beside = rg.placement_map(shape, WEIGHT_IN_PLANE, friction=0.5, fixed=[0.01], free=2, count=6)
    with pytest.raises(rg.InvalidInput, match="two fingers"):
        plots.plot_placement_map(beside, regions=regions)


def test_the_map_of_one_finger_is_drawn_on_the_outline_only() -> None:
    found = rg.placement_map(SQUARE_OUTLINE, WEIGHT_IN_PLANE, friction=0.5, fixed=[0.2], free=1, count=16)
    ax = plots.plot_placement_outline(found)
    assert [line.get_xydata()[0] for line in ax.lines if line.get_gid() == "fixed"] == [
        pytest.approx(SQUARE_OUTLINE.points([0.2])[0])
    ]
    with pytest.raises(rg.InvalidInput, match="plot_placement_outline"):
        plots.plot_placement_map(found)


def test_regions_on_faces_are_drawn_where_they_are() -> None:
    ax = plots.plot_contact_regions(on_faces())
    ids = [artist.get_gid() for artist in ax.collections]
    assert sum(str(name).startswith("region ") for name in ids) == 3
    words = [text.get_text() for text in ax.get_legend().get_texts()]
    for name, word, radius in zip(on_faces().grasp.names, words, on_faces().reach, strict=False):
        assert word.startswith(f"{name} {radius:.2g}".rstrip("0"))
        assert ", alone " in word
    assert " m at once" in words[-1]


def test_the_map_of_a_mesh_has_the_colours_of_the_nearest_points() -> None:
    found = mapped()
    ax = plots.plot_surface_map(found)
    drawn = {artist.get_gid(): artist for artist in ax.collections}
    assert len(np.unique(drawn["values"].get_facecolor(), axis=0)) > 2
    assert ax.figure.axes[1].get_ylabel() == "peak [N]"


def test_a_legend_ends_within_the_figure() -> None:
    bracket = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
    below = rg.Grasp(bracket.contact_at(s, friction=0.4) for s in (0.02, 0.5, 3.98))
    regions = rg.contact_regions(bracket, below, rg.Wrench([0, -1]))
    assert regions.ended.any()  # of the longest words
    found = rg.choose_grasp(
        SQUARE_OUTLINE, 2, WEIGHT_IN_PLANE, friction=0.4, objective="friction_use", max_force=6
    )
    for ax in (plots.plot_contact_regions(regions), plots.plot_chosen_grasp(found)):
        figure = ax.figure
        figure.draw_without_rendering()
        legend = ax.get_legend()
        assert legend is not None
        assert legend.get_window_extent().x1 <= figure.bbox.x1
