"""Which directions of a load a grasp in space can bear, on a sphere and on a map that shows its back, too."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize, to_rgba
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, array
from regrasp.plots.grasps.space_body import RIM, write
from regrasp.plots.look.arrows import arrow3d
from regrasp.plots.look.space_axes import in_space
from regrasp.plots.look.style import GREY, INK, PALETTE, SMALL, TEXT, WIDTH, new_figure, short

HELD, NOT_HELD = PALETTE[5], "#ebebeb"
_ROWS = 90  # of patches from pole to pole
_DOTS = 600  # directions, at most, that are marked one by one on the map
_AZIMUTH, _ELEVATION = 40.0, 25.0  # x, y and z point to the reader
_CHUNK = 2048  # patches compared with all directions at once


def plot_load_sphere(
    directions: ArrayLike, values: ArrayLike, ax: Any = None, *, label: str = "least angle margin [deg]"
) -> Any:
    """A sphere of load directions in the object frame, each patch coloured like the direction nearest to it.

    Args:
        directions: (m, 3), not zero, of any length; between them nothing is known, so sample them evenly.
        values: (m,) margins, NaN where the load is not held; or booleans, held or not.
        ax: 3-D. The back is hidden: ``plot_load_map`` shows all, ``load_sphere_figure`` both side by side.
        label: of the colour bar, with the unit. Loads that are not held are pale, and hatched on the map.

    Raises:
        InvalidInput: For other shapes and flat axes.
    """
    known = _known(directions, values)
    if ax is None:
        figure = new_figure(height=3.3)
        figure.set_layout_engine("none")
        ax = figure.add_axes((0.0, 0.0, 0.76, 1.0), projection="3d")
        _draw_sphere(ax, known)
        _key(figure, known, label, (0.8, 0.25, 0.03, 0.5), (0.02, 0.02))
        return ax
    return _draw_sphere(in_space(ax), known)


def plot_load_map(
    directions: ArrayLike,
    values: ArrayLike,
    ax: Axes | None = None,
    *,
    label: str = "least angle margin [deg]",
) -> Axes:
    """All load directions on one equal-area map (Hammer's); as ``plot_load_sphere``.

    Longitude is the angle about z from x, latitude the angle from the xy plane, up to z. Black dots are the
    directions given, where they are few enough to see.

    Args:
        directions: (m, 3) directions of the load, object frame, of any length but zero.
        values: (m,) of each, NaN where the load is not held.
        ax: with ``projection="hammer"`` or another map.
        label: the words beside it.
    """
    known = _known(directions, values)
    if ax is None:
        figure = new_figure(height=2.5)
        figure.set_layout_engine("none")
        ax = figure.add_axes((0.08, 0.2, 0.9, 0.73), projection="hammer")
        _draw_map(ax, known)
        _key(figure, known, label, (0.4, 0.16, 0.5, 0.03), (0.02, 0.02))
        return ax
    if ax.name not in ("hammer", "mollweide", "aitoff", "lambert"):
        raise InvalidInput("ax must be a map of the sphere: figure.add_subplot(projection='hammer')")
    return _draw_map(ax, known)


def load_sphere_figure(
    directions: ArrayLike, values: ArrayLike, *, label: str = "least angle margin [deg]"
) -> Figure:
    """``plot_load_sphere`` and ``plot_load_map`` side by side under one scale of colours.

    Args:
        directions: (m, 3) directions of the load, object frame, of any length but zero.
        values: (m,) of each, NaN where the load is not held.
        label: the words beside it.
    """
    known = _known(directions, values)
    figure = new_figure(2 * WIDTH, 2.7)
    figure.set_layout_engine("none")
    _draw_sphere(figure.add_axes((-0.01, 0.0, 0.4, 1.0), projection="3d"), known)
    _draw_map(figure.add_axes((0.4, 0.24, 0.58, 0.7), projection="hammer"), known)
    _key(figure, known, label, (0.6, 0.17, 0.34, 0.03), (0.41, 0.04))
    return figure


class _Known(NamedTuple):
    """Unit directions (m, 3), their values (m,), NaN for not held, and whether these are margins."""

    directions: Array
    values: Array
    margins: bool


def _known(directions: ArrayLike, values: ArrayLike) -> _Known:
    d = array(directions, "directions", (None, 3))
    lengths = np.linalg.norm(d, axis=1, keepdims=True)
    if not len(d) or not lengths.all():
        raise InvalidInput("directions must be one or more vectors, none of them zero")
    try:
        given = np.asarray(values)
    except (TypeError, ValueError):  # rows of several lengths
        given = np.empty(0, dtype=object)
    if given.shape != (len(d),) or given.dtype.kind not in "biuf":
        raise InvalidInput(
            f"values must be a number or a boolean for each of {len(d)} directions, got {shown(values)}"
        )
    if given.dtype.kind == "b":
        return _Known(d / lengths, np.where(given, 1.0, np.nan), False)
    if np.isinf(given).any():
        raise InvalidInput("values must be finite, or NaN where the load is not held; got an infinite one")
    return _Known(d / lengths, given.astype(float), True)


def _scale(known: _Known) -> tuple[ListedColormap | str, Normalize]:
    """Colours of what is held. Viridis has no white and no grey, and is safe for colour-blind readers."""
    if not known.margins:
        return ListedColormap([HELD]), Normalize(0, 2)
    held = known.values[np.isfinite(known.values)]
    low, high = (float(held.min()), float(held.max())) if held.size else (0.0, 1.0)
    low = min(0.0, low)
    return "viridis", Normalize(low, high if high > low else low + 1.0)


def _painted(known: _Known, points: Array) -> NDArray[np.float64]:
    """(..., 4) the colour of the nearest direction, for unit points (..., 3)."""
    flat = points.reshape(-1, 3)
    parts = [flat[k : k + _CHUNK] @ known.directions.T for k in range(0, len(flat), _CHUNK)]
    value = known.values[np.concatenate([part.argmax(axis=1) for part in parts])]
    colour_map, norm = _scale(known)
    colours = np.array(ScalarMappable(norm, colour_map).to_rgba(np.nan_to_num(value)))
    colours[np.isnan(value)] = to_rgba(NOT_HELD)
    return colours.reshape(*points.shape[:-1], 4)


def _sphere(longitude: Array, latitude: Array) -> Array:
    result: Array = np.stack(
        [
            np.cos(latitude) * np.cos(longitude),
            np.cos(latitude) * np.sin(longitude),
            np.sin(latitude) + 0 * longitude,
        ],
        axis=-1,
    )
    return result


def _patches(rows: int) -> tuple[Array, Array, Array]:
    """Edges of longitude and latitude [rad], and middles of the patches between them (rows, 2 rows, 3)."""
    longitude, latitude = (
        np.linspace(-np.pi, np.pi, 2 * rows + 1),
        np.linspace(-np.pi / 2, np.pi / 2, rows + 1),
    )
    middle = np.meshgrid((longitude[1:] + longitude[:-1]) / 2, (latitude[1:] + latitude[:-1]) / 2)
    return longitude, latitude, _sphere(*middle)


def _draw_sphere(ax: Any, known: _Known) -> Any:
    ax.set_proj_type("ortho")
    ax.computed_zorder = False
    longitude, latitude, middle = _patches(_ROWS // 2)
    x, y, z = np.moveaxis(_sphere(*np.meshgrid(longitude, latitude)), -1, 0)
    ball = ax.plot_surface(
        x, y, z, facecolors=_painted(known, middle), rstride=1, cstride=1, shade=False, linewidth=0
    )
    ball.set(gid="sphere", antialiased=False, zorder=1)
    ax.view_init(_ELEVATION, _AZIMUTH)
    for name, axis in zip("xyz", np.eye(3), strict=True):
        arrow3d(ax, 1.02 * axis, 1.35 * axis, gid=f"axis {name}", color=INK, linewidth=1.0, zorder=2)
        write(ax, f"${name}$", 1.35 * axis, axis, 0.05, gid=f"name {name}")
    ax.set(xlim=(-1, 1), ylim=(-1, 1), zlim=(-1, 1))
    ax.set_box_aspect((1, 1, 1), zoom=1.12)
    ax.set_axis_off()
    return ax


def _draw_map(ax: Axes, known: _Known) -> Axes:
    longitude, latitude, middle = _patches(_ROWS)
    colours = _painted(known, middle)
    patches = ax.pcolormesh(longitude, latitude, colours, rasterized=True, zorder=1)
    patches.set_gid("map")
    held = (colours != to_rgba(NOT_HELD)).any(axis=-1)
    if not held.all():
        at = [(edges[1:] + edges[:-1]) / 2 for edges in (longitude, latitude)]
        hatched = ax.contourf(*at, held, levels=[-0.5, 0.5], colors="none", hatches=["////"], zorder=2)
        hatched.set(edgecolor=GREY, linewidth=0, gid="not held")
    if len(known.directions) <= _DOTS:
        x, y, z = known.directions.T
        ax.plot(
            np.arctan2(y, x), np.arcsin(z.clip(-1, 1)), ".", color=INK, markersize=1.5, zorder=4, gid="given"
        )
    ax.grid(color=GREY, linewidth=0.4, alpha=0.6)
    ax.set_xticks(np.radians([-90, 0, 90]), ["$-y$", "$x$", "$y$"], fontsize=TEXT, path_effects=[RIM])
    ax.set_yticks(np.radians([-60, -30, 0, 30, 60]))
    ax.tick_params(labelsize=SMALL)
    for name, at_pole in (("$z$", np.pi / 2), ("$-z$", -np.pi / 2)):
        va = "bottom" if at_pole > 0 else "top"
        ax.text(0, at_pole, name, fontsize=TEXT, ha="center", va=va)
    return ax


def _key(
    figure: Figure,
    known: _Known,
    label: str,
    bar: tuple[float, float, float, float],
    corner: tuple[float, float],
) -> None:
    """A colour bar where margins are drawn, and what pale means where something is not held."""
    keys = []
    if known.margins and np.isfinite(known.values).any():
        colour_map, norm = _scale(known)
        upright = bar[3] > bar[2]
        drawn = figure.colorbar(
            ScalarMappable(norm, colour_map),
            cax=figure.add_axes(bar),
            orientation="vertical" if upright else "horizontal",
        )
        drawn.set_label(label, fontsize=TEXT)
        drawn.ax.tick_params(labelsize=SMALL, length=2.5)
        (drawn.ax.yaxis if upright else drawn.ax.xaxis).set_major_formatter(lambda value, _: short(value))
    elif not known.margins:
        keys.append(Patch(facecolor=HELD, label="held"))
    if np.isnan(known.values).any():
        keys.append(Patch(facecolor=NOT_HELD, edgecolor=GREY, linewidth=0.6, hatch="////", label="not held"))
    if keys:
        figure.legend(handles=keys, loc="lower left", bbox_to_anchor=corner, fontsize=SMALL, frameon=False)
