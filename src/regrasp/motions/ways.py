"""A finger's way from one place to another: along the normal, around, along the normal, corners rounded."""

from dataclasses import dataclass

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.motions.rounded import RoundedWay
from regrasp.motions.stands import Space, Stand

Found = tuple[RoundedWay, tuple[float, float]]
"""A way, and the gaps that it keeps to the object and to fingers that stand [m]."""

_HALVINGS = 30  # of a rounding that is not clear


@dataclass(frozen=True)
class Stop:
    """Where a tip's centre is at an end of a way: free in the air, or at a contact that it lifts off."""

    point: Array
    contact: Stand | None = None

    @property
    def free(self) -> Array:
        """(d,) where it is free in the air [m]."""
        return self.point if self.contact is None else self.contact.tip(False)

    @property
    def lift(self) -> float:
        """How far from here it is near the object [m]."""
        return 0.0 if self.contact is None else self.contact.exit

    @property
    def landing(self) -> float:
        """How far from here the way is along the normal [m]."""
        return float(np.linalg.norm(self.point - self.free))


def way_between(a: Stop, b: Stop, others: Array, space: Space) -> Found | None:
    """The way and the gaps it keeps to the object and to others [m]; None where there is none.

    others: (j, 2, d) tips and capsules that stand.
    """
    if np.allclose(a.free, b.free, rtol=0, atol=1e-9 * space.clearance):
        over: Array | None = a.free[None]
    else:
        over = space.way(a.free, b.free, others)
    if over is None:
        return None
    ends = [[stop.point] if stop.contact is not None else [] for stop in (a, b)]
    return rounded(np.vstack([*ends[0], over, *ends[1]]), a.lift, b.lift, others, space)


def rounded(points: Array, lifted: float, landed: float, others: Array, space: Space) -> Found | None:
    """A polygon (k, d) with its corners rounded as far as that is clear, and its gaps; None without.

    lifted, landed: how much of it at both ends is at a contact, and so near the object [m].
    """
    apart = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate([[True], apart > 1e-9 * space.clearance])]
    for part in (points[:2], points[-2:]):  # along the normals
        if not space.keeps_apart(part, others):
            return None
    cuts = np.zeros(len(points) - 2)
    lengths = np.linalg.norm(np.diff(points, axis=0), axis=1)
    for i in range(cuts.size):
        p, u, v = points[i + 1], points[i] - points[i + 1], points[i + 2] - points[i + 1]
        most = min(lengths[i : i + 2].min() / 2, space.tip_radius + space.clearance)
        if (lifted and i == 0) or (landed and i == cuts.size - 1):
            most = min(most, space.clearance)  # the rest of these parts is along the normal
        for _ in range(_HALVINGS):
            corner = np.array([p + most * u / lengths[i], p, p + most * v / lengths[i + 1]])
            if space.keeps_clear(corner, others):
                break
            most /= 2
        cuts[i] = most
    way = RoundedWay(points, cuts)
    gaps = space.gaps(*_pieces(way, lifted, landed), others)
    return None if min(gaps) < space.clearance * (1 - 1e-9) else (way, gaps)


def _pieces(way: RoundedWay, lifted: float, landed: float) -> tuple[list[Array], list[Array]]:
    """Hulls of the way: away from its contacts, and all of it."""
    corners = []
    for i, h in enumerate(way.cuts):
        p = way.points[i + 1]
        corners.append(np.array([p - h * way.directions[i], p, p + h * way.directions[i + 1]]))
    free = way.points.copy()
    free[0] = free[0] + min(lifted, way.lengths[0]) * way.directions[0]
    free[-1] = free[-1] - min(landed, way.lengths[-1]) * way.directions[-1]
    return ([*_sides(free), *corners], [*_sides(way.points), *corners])


def _sides(points: Array) -> list[Array]:
    return [points[i : i + 2] for i in range(len(points) - 1)]
