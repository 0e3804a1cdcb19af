"""The holds of a plan as a path over the arc lengths of two fingers."""

import numpy as np
from matplotlib.axes import Axes

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plots.look.style import INK, PALETTE, note

PATH = PALETTE[1]
# Contacts are on an outline within this fraction of its length.
_ON = 1e-6
_MOST_NUMBERED = 12


def place_of(outline: Outline, contact: Contact) -> float:
    """The arc length of a contact [m]."""
    s = outline.nearest(contact.position + outline.centre_of_mass)
    if np.hypot(*(outline.points(s) - contact.position)) > _ON * outline.length:
        raise InvalidInput(f"contact {shown(contact.name)} is not on the outline")
    return s % outline.length


def path_of(plan: RegraspPlan, outline: Outline) -> Array:
    """(h, 2) places of the two fingers of every hold [m]."""
    held = []
    for step in plan.steps[:-1]:
        names = [name for name in step.grasp.names if name not in step.idle_at_end]
        if len(names) == 2:  # else all three hold between two steps
            held.append([place_of(outline, step.grasp[name]) for name in names])
    return by_fingers(np.array(held).reshape(-1, 2))


def by_fingers(holds: Array) -> Array:
    """Holds (h, 2) in which a finger that stays keeps its axis."""
    path: list[Array] = []
    for hold in holds:
        if path and abs(hold[::-1] - path[-1]).min() < abs(hold - path[-1]).min():
            hold = hold[::-1]
        path.append(hold)
    return np.array(path).reshape(-1, 2)


def draw_path(ax: Axes, path: Array) -> None:
    """From the square to the disc; few holds with their numbers."""
    ax.plot(*path.T, color="white", linewidth=2.8, zorder=3, solid_joinstyle="round")
    ax.plot(*path.T, color=PATH, linewidth=1.4, zorder=4, gid="path", solid_joinstyle="round")
    ax.plot(*path[1:-1].T, "o", color=PATH, markersize=3, zorder=5)
    for at, marker in (*((at, "s") for at in path[:1]), *((at, "o") for at in path[-1:])):
        ax.plot(*at, marker, color=PATH, markeredgecolor="white", markersize=7, zorder=5)
    seen: dict[tuple[float, float], list[str]] = {}
    for k, (x, y) in enumerate(path.tolist(), 1):
        seen.setdefault((x, y), []).append(str(k))
    if len(seen) <= _MOST_NUMBERED:
        for at_place, numbers in seen.items():
            note(ax, ", ".join(numbers), at_place, (1, 1), gap=5, color=INK)
