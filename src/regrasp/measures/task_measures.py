"""The largest factor by which a set of loads may be scaled so that all of it is balanced.

Wrenches that are balanced are a convex set. It holds a hull if it holds its corners, so that the factor of a
hull is the least of the largest loads towards them, exactly. Of a round set, members found to be the limit
bound the factor from above; from below a tilt does by corners around it, and an ellipsoid center + k A z, |z|
<= 1, by the hull of points k_j z_j that are balanced: its widest ball around 0, where a facet is nearest.
Largest loads along the normals of nearest facets close in on it.
"""

from math import inf

import numpy as np

from regrasp.errors import Infeasible
from regrasp.measures.measure import ROA, Measure
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.states.choosing import choose_state
from regrasp.planning.surveys.extremes.largest_load import LargestLoad, largest_load

_PROGRAMS = 200  # largest loads of one measure
_STARTS, _STEPS = 6, 8
_FLAT = 1e-12
_FAR = 1e3  # points count up to this multiple of the nearest


def task_measure(grasp: Grasp, loads: LoadSet, gap: float) -> Measure:
    """The largest factor of a set whose members all are balanced, each by forces of its own.

    The contacts' own ``max_force`` limits count; 0 where the center is not held. gap: of ellipsoids, at which
    the search ends.
    """
    task = _Task(grasp, loads.center)
    corners, axes, how = loads.cover, loads.half_axes, "search"
    if not task.is_held:
        lower = upper = 0.0
    elif axes is not None:
        lower, upper = task.ellipsoid(axes, gap)
    else:
        assert corners is not None  # all but ellipsoids have some
        lower, upper = task.hull(corners - loads.center.vector)
        if loads.vertices is None:
            upper = task.members(loads.deviations)
        else:
            how = "program"
    lower = min(lower, upper)
    return Measure(
        "task_factor", lower, "-", "[0, inf]", True, "max k: center + k (loads - center) all balanced",
        f"{ROA}; Borst, Fischer and Hirzinger 2004", "none", how, (lower, upper),
    )  # fmt: skip


class _Task:
    """Largest loads away from a center."""

    def __init__(self, grasp: Grasp, center: Wrench) -> None:
        self.grasp, self.center = grasp, center
        self.asked = 0

    @property
    def is_held(self) -> bool:
        """Whether the center is."""
        try:
            return (
                not self.center.vector.any()
                or choose_state(self.grasp, self.center, "effort", reserve=0.0) is not None
            )
        except Infeasible:
            return False

    def along(self, away: Array) -> tuple[float, float, LargestLoad | None]:
        """(lower, upper) of the factor of a deviation."""
        self.asked += 1
        if not away.any():
            return inf, inf, None
        try:
            found = largest_load(self.grasp, Wrench.from_vector(away), self.center)
        except Infeasible:
            return 0.0, 0.0, None
        return max(found.factor, 0.0), max(found.bounds[1], 0.0), found

    def hull(self, corners: Array) -> tuple[float, float]:
        """(lower, upper) of deviations (m, 3) or (m, 6) and all between."""
        lower, upper = inf, inf
        for away in corners:
            low, high, _ = self.along(away)
            lower, upper = min(lower, low), min(upper, high)
            if high == 0:
                break
        return lower, upper

    def members(self, deviations: LoadSet) -> float:
        """The least upper bound of members, along the twists that prove those before them."""
        size, best = deviations.center.vector.size, inf
        starts = np.vstack([np.eye(size), -np.eye(size)])
        for start in starts if size == 3 else starts[: 2 * _STARTS]:
            twist = start
            for _ in range(_STEPS):
                _, high, found = self.along(deviations.extreme(twist).vector)
                best = min(best, high)
                if found is None or found.escape is None:
                    break
                twist = found.escape.twist
        return best

    def ellipsoid(self, axes: Array, gap: float) -> tuple[float, float]:
        """(lower, upper) of A z, |z| <= 1."""
        sides, sizes, _ = np.linalg.svd(axes)
        rank = int((sizes > _FLAT * sizes.max(initial=0.0)).sum())
        if not rank:
            return inf, inf
        a = sides[:, :rank] * sizes[:rank]
        asked: list[tuple[float, Array]] = []
        upper = inf

        def ask(z: Array) -> float:
            nonlocal upper
            low, high, _ = self.along(a @ z)
            upper = min(upper, high)
            asked.append((low, z))
            return low

        for z in np.vstack([np.eye(rank), -np.eye(rank)]):
            if not ask(z) > 0:
                return 0.0, upper
        if upper == inf:  # whole axes are held, and with them all
            return inf, inf
        while True:
            points = np.array([min(low, _FAR * upper) * z for low, z in asked])
            lower, z = _nearest_facet(points)
            if lower >= (1 - gap) * upper or self.asked >= _PROGRAMS:
                return lower, upper
            ask(z)


def _nearest_facet(points: Array) -> tuple[float, Array]:
    """How far the hull of points around 0 reaches in all directions, and the normal of its nearest facet."""
    from scipy.spatial import ConvexHull

    if points.shape[1] == 1:
        nearest = int(np.abs(points[:, 0]).argmin())
        return float(abs(points[nearest, 0])), np.sign(points[nearest])
    facets = ConvexHull(points).equations
    nearest = int(facets[:, -1].argmax())
    return float(-facets[nearest, -1]), facets[nearest, :-1]
