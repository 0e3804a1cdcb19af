"""A set of loads as its shadow on two of a load's components."""

from math import pi

import numpy as np
from matplotlib.axes import Axes

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, instance
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.plots.look.style import INK, PALETTE, axes_or_new, label_axis, legend
from regrasp.plots.look.units import SI, Units

_COMPONENTS = {
    2: {"fx": r"$f_x$", "fy": r"$f_y$", "torque": r"$\tau$"},
    3: {f"{part}{a}": rf"${symbol}_{a}$" for part, symbol in (("f", "f"), ("t", r"\tau")) for a in "xyz"},
}
_AROUND = 721


def plot_load_set(
    loads: LoadSet,
    ax: Axes | None = None,
    *,
    components: tuple[str, str] = ("fx", "fy"),
    label: str | None = None,
    units: Units = SI,
) -> Axes:
    """The shadow of a set of loads on two components, filled, with its center: exact for every set.

    A load is a member only if each of its shadows is inside. Several sets on the same axes take colours in
    turn.

    Args:
        loads: the set.
        ax: the axes to draw on; new ones if not given.
        components: which two: ``fx``, ``fy`` and ``torque`` in the plane, ``fx``, ``fy``, ``fz``, ``tx``,
            ``ty`` and ``tz`` in space.
        label: for the legend; none if not given.
        units: what one unit of length, force and time is called; nothing is converted.

    Raises:
        InvalidInput: For other components.
    """
    instance(loads, "loads", LoadSet)
    names = _COMPONENTS[loads.dimension]
    first, second = _places(components, list(names))
    ax = axes_or_new(ax)
    colour = PALETTE[sum(patch.get_gid() == "load set" for patch in ax.patches) % len(PALETTE)]
    rim = _rim(loads, first, second)
    ax.fill(*rim.T, facecolor=colour, edgecolor=colour, alpha=0.25, linewidth=0, gid="load set", label=label)
    ax.plot(*rim.T, color=colour, linewidth=1.2, gid="load set rim")
    ax.plot(*loads.center.vector[[first, second]], color=INK, marker="+", markersize=5, gid="center")
    torques = [list(names).index(name) >= loads.dimension for name in components]
    if torques[0] == torques[1]:
        ax.set_aspect("equal", adjustable="datalim")
    for axis, name, is_torque, values in zip((ax.xaxis, ax.yaxis), components, torques, rim.T, strict=True):
        label_axis(axis, names[name], units.torque if is_torque else units.force, float(np.abs(values).max()))
    if label is not None:
        legend(ax)
    return ax


def _places(components: tuple[str, str], names: list[str]) -> tuple[int, int]:
    given = components if isinstance(components, (tuple, list)) else ()
    if len(given) != 2 or any(name not in names for name in given) or given[0] == given[1]:
        raise InvalidInput(f"components must be two of {', '.join(names)}, got {shown(components)}")
    return names.index(given[0]), names.index(given[1])


def _rim(loads: LoadSet, first: int, second: int) -> Array:
    """(m, 2) the boundary of the shadow: the members farthest along directions around."""
    angles = 2 * pi * np.arange(_AROUND) / (_AROUND - 1)
    size = loads.center.vector.size
    corners = loads.vertices
    reach = np.ones(2)  # of the two components, so that rounds are round in numbers of any size
    for k, place in enumerate((first, second)):
        unit = np.eye(size)[place]
        reach[k] = float(loads.support(unit) + loads.support(-unit)) or 1.0
    rim = np.empty((_AROUND, 2))
    for k, angle in enumerate(angles.tolist()):
        twist = np.zeros(size)
        twist[first], twist[second] = np.cos(angle) / reach[0], np.sin(angle) / reach[1]
        rim[k] = loads.extreme(twist).vector[[first, second]]
    if corners is None:
        return rim
    kept = np.append(True, (np.abs(np.diff(rim, axis=0)) > 0).any(axis=1))
    return np.vstack([rim[kept], rim[:1]])
