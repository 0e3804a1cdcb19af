"""Maps and spheres of load directions carry the values they were given."""

from math import inf

import numpy as np
import pytest
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

import regrasp as rg
from drawn import PNG, by_gid, one
from regrasp import plots
from regrasp.plots.surveys import held_sphere

pytestmark = pytest.mark.contract


def evenly(count):
    k = np.arange(count) + 0.5
    z, a = 1 - 2 * k / count, np.pi * (1 + np.sqrt(5)) * k
    return np.column_stack([np.sqrt(1 - z**2) * np.cos(a), np.sqrt(1 - z**2) * np.sin(a), z])


def colour_at(ax, direction):
    """The colour of the map's patch in a direction."""
    mesh = one(ax, "map")
    x, y, z = direction / np.linalg.norm(direction)
    colours = mesh.get_facecolor().reshape(*mesh.get_coordinates()[:-1, :-1, 0].shape, 4)
    rows, columns = colours.shape[:2]
    row = int((np.arcsin(z) / np.pi + 0.5) * rows * (1 - 1e-12))
    column = int((np.arctan2(y, x) / (2 * np.pi) + 0.5) * columns * (1 - 1e-12))
    return colours[row, column]


def test_the_map_shows_the_value_of_the_nearest_direction():
    directions = 3.0 * evenly(200)
    margins = np.where(directions[:, 2] < 0, 10 - 2 * directions[:, 0], np.nan)
    ax = plots.plot_load_map(directions, margins)
    ax.figure.draw_without_rendering()
    (bar,) = [other for other in ax.figure.axes if other is not ax]
    low, high = bar.get_xlim()
    assert (low, high) == pytest.approx((0, np.nanmax(margins)))
    from matplotlib import colormaps

    for direction, margin in zip(directions, margins, strict=True):
        pale = held_sphere.to_rgba(held_sphere.NOT_HELD)
        wanted = pale if np.isnan(margin) else colormaps["viridis"](margin / high)
        np.testing.assert_allclose(colour_at(ax, direction), wanted, atol=0.006)
    assert bar.get_xlabel() == "least angle margin [deg]"
    assert by_gid(ax, "not held")
    assert "not held" in [t.get_text() for legend in ax.figure.legends for t in legend.get_texts()]


def test_held_or_not_needs_no_colour_bar():
    directions = evenly(100)
    figure = plots.load_sphere_figure(directions, directions[:, 0] > 0)
    assert len(figure.axes) == 2
    assert [t.get_text() for legend in figure.legends for t in legend.get_texts()] == ["held", "not held"]
    everything = plots.load_sphere_figure(directions, np.full(100, True))
    assert [t.get_text() for legend in everything.legends for t in legend.get_texts()] == ["held"]
    nothing = plots.load_sphere_figure(directions, np.full(100, np.nan))
    assert len(nothing.axes) == 2
    assert plots.png(nothing).startswith(PNG)


def test_the_sphere_carries_the_colours_of_the_map():
    directions = evenly(400)
    ax = plots.plot_load_sphere(directions, directions[:, 2] < 0)
    sphere = one(ax, "sphere", Poly3DCollection)
    held = np.isclose(sphere._facecolor3d, held_sphere.to_rgba(held_sphere.HELD)).all(axis=1)
    heights = np.array([face[:, 2].mean() for face in sphere._faces])
    assert held[heights < -0.2].all()
    assert not held[heights > 0.2].any()


def test_load_directions_are_checked():
    for directions, values, said in (
        ([[0, 0, 0]], [1.0], "none of them zero"),
        (np.empty((0, 3)), [], "one or more"),
        ([[1, 0, 0]], [1.0, 2.0], "for each of 1 directions"),
        ([[1, 0, 0]], ["yes"], "number or a boolean"),
        ([[1, 0, 0]], [inf], "must be finite"),
    ):
        for draw in (plots.plot_load_sphere, plots.plot_load_map, plots.load_sphere_figure):
            with pytest.raises(rg.InvalidInput, match=said):
                draw(directions, values)
    flat = Figure().add_subplot()
    with pytest.raises(rg.InvalidInput, match="ax must be 3-D"):
        plots.plot_load_sphere([[1, 0, 0]], [1.0], flat)
    with pytest.raises(rg.InvalidInput, match="projection='hammer'"):
        plots.plot_load_map([[1, 0, 0]], [1.0], flat)
