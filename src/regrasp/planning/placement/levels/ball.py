"""The level of Ferrari and Canny's measure: the radius of a ball of wrenches that limited fingers make."""

from contextlib import suppress
from itertools import combinations
from math import nan, sqrt

import numpy as np

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.placement.levels.level import AT_THE_EDGE, Level, Shown
from regrasp.planning.placement.search import Search
from regrasp.planning.states.choosing import choose_state

_AROUND = 5  # directions to begin with along each side of a cube
_SAME = 1e-6
_LEAST = 1e-5  # gap, well above what directions told apart make
_NEARER = 0.999  # of the tolerance: what is given back to rounding is within it, too
_STEP = 1e-6  # of the limit, beyond none at all
_FLAT = 1e-14
_ROUNDING = 1e-12
_NONE = 1e-9  # of the limit: where some load is not held at all, rounding leaves less


class BallLevel(Level):
    """Wrenches of one size, torques divided by ``length``, along directions: the level is the size [N].

    A placement is bounded by some directions of loads. Those in which placements that were found are weakest
    come to them as the search goes on: whatever fails one is no better.
    """

    start = 0.0

    def __init__(self, max_force: float, friction: float, length: float) -> None:
        super().__init__(max_force)
        self.friction, self.length = friction, length
        ticks = np.linspace(-1, 1, _AROUND)
        cube = np.stack(np.meshgrid(ticks, ticks, ticks), axis=-1).reshape(-1, 3)
        cube = cube[np.abs(cube).max(axis=1) == 1]
        self.directions: Array = cube / np.linalg.norm(cube, axis=1)[:, None]

    def loads(self, level: float) -> Array:
        """(L, 3) of the size, along all directions [N, N m]."""
        result: Array = level * self.directions * [1.0, 1.0, self.length]
        return result

    def put(self, search: Search, level: float) -> None:
        """Loads of this size."""
        search.under(self.loads(level))

    def beyond(self, level: float, tolerance: float) -> float:
        """Larger by a fraction of it."""
        return level + max(max(_NEARER * tolerance, _LEAST) * level, _STEP * self.max_force)

    def top(self, search: Search) -> float:
        """Forces of the limit make no larger one."""
        return search.fingers * self.max_force * sqrt(1 + self.friction**2)

    def of(self, search: Search, places: np.ndarray, u: Array) -> float:
        """The radius of a placement; NaN where it is no more than rounding."""
        radius = self.reached(search, self.start, places, u)
        return radius if radius > _NONE * self.max_force else nan

    def reached(self, search: Search, known: float, places: np.ndarray, u: Array) -> float:
        """The radius of a placement, be it less than what is known; its weakest direction is remembered."""
        contacts = [
            search.sides.contact(int(j), float(v), self.friction, "F") for j, v in zip(places, u, strict=True)
        ]
        positions, normals = np.array([c.position for c in contacts]), np.array([c.normal for c in contacts])
        radius, weakest = ball(positions, normals, self.friction, self.max_force, self.length)
        if np.linalg.norm(self.directions - weakest, axis=1).min() > _SAME:
            self.directions = np.vstack([self.directions, weakest])
        return radius

    def shown(self, grasp: Grasp, objective: str, loads: Array, level: float) -> Shown | None:
        """A state under the wrench that is hardest, and the radius."""
        radius, weakest = ball(grasp.positions, grasp.normals, self.friction, self.max_force, self.length)
        radius = radius if radius > _NONE * self.max_force else 0.0
        for back in AT_THE_EDGE:
            load = Wrench.from_vector((1 - back) * radius * weakest * [1.0, 1.0, self.length])
            with suppress(Infeasible):
                state = choose_state(grasp, load, "peak_normal")
                if state.value <= self.max_force:
                    return [state], radius * (1 - _ROUNDING)
        return None


def ball(
    positions: Array, normals: Array, friction: float, limit: float, length: float
) -> tuple[float, Array]:
    """The radius of the largest ball, exact but for rounding, and the direction of the load held least.

    The wrenches are a sum of triangles (0, e_-, e_+), whose facets span two of the triangles' sides.
    """
    tangents = np.stack([-normals[:, 1], normals[:, 0]], axis=1)
    forces = limit * np.concatenate([normals - friction * tangents, normals + friction * tangents])
    points = np.tile(positions, (2, 1)) / length
    edges = np.column_stack([forces, points[:, 0] * forces[:, 1] - points[:, 1] * forces[:, 0]])
    k = len(positions)
    sides = np.vstack([edges, edges[k:] - edges[:k]])
    first, second = np.array(list(combinations(range(3 * k), 2))).T
    facets = np.cross(sides[first], sides[second])
    sizes = np.linalg.norm(facets, axis=1)
    long = sizes > _FLAT * sizes.max(initial=0.0)
    facets = facets[long] / sizes[long][:, None]
    if not len(facets):
        return 0.0, np.array([0.0, 0.0, 1.0])
    facets = np.vstack([facets, -facets])
    each = np.maximum(facets @ edges.T, 0.0)
    h = np.maximum(each[:, :k], each[:, k:]).sum(axis=1)
    least = int(h.argmin())
    return float(h[least]), -facets[least]
