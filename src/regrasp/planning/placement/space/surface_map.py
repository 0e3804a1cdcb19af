"""The best value that is reached with a finger at each point of a mesh, the others wherever they are best."""

from dataclasses import dataclass
from math import inf

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, number, read_only, whole
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.planning.placement.laws import law_of
from regrasp.planning.placement.space.choosing import check_space
from regrasp.planning.placement.space.patches import patches_of
from regrasp.planning.placement.space.surface_search import SurfaceSearch
from regrasp.planning.states.objectives import Objective

_TOLERANCE = 0.01
_MOST_BOXES = 50_000
_APART = 1e-6  # of the reach


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceMap(ArrayValue):
    """The best value through each of some points of a mesh.

    Args:
        shape: the mesh.
        objective: its word.
        fingers: how many hold.
        points: (m, 3) spread evenly, relative to the centre of mass [m].
        normals: (m, 3) inward.
        best: (m,) the least value of grasps with a finger there and the others on any of the points, to a
            hundredth, in the unit of the objective; NaN for none.
    """

    shape: Mesh
    objective: str
    fingers: int
    points: Array
    normals: Array
    best: Array

    @property
    def share(self) -> float:
        """The share of the points through which a grasp holds the loads [-]."""
        return float((~np.isnan(self.best)).mean())

    def __repr__(self) -> str:
        points = f"{len(self.points)} points"
        return f"SurfaceMap({self.objective} of {self.fingers}, {points}, {self.share:.0%} hold)"


def surface_map(
    shape: Mesh,
    fingers: int,
    load: Wrench | LoadSet,
    *,
    friction: float,
    objective: str | Objective = "sum_normal",
    count: int = 150,
) -> SurfaceMap:
    """Where on a mesh a finger is worth having: the best value that is reached with one at each point.

    Args:
        shape: of flat faces.
        fingers: how many, 2 to 4; all alike.
        load: external wrench on the object about its centre of mass, or a hull of some; the value is that of
            the worst load [N, N m].
        friction: coefficient of all fingers [-].
        objective: ``sum_normal``, ``peak_normal``, ``peak`` or ``effort``.
        count: points, spread evenly over the surface, on which all fingers are.

    Raises:
        InvalidInput: For arguments that are not what they must be.
    """
    if not isinstance(shape, Mesh):
        raise InvalidInput(f"shape must be a Mesh, got {shown(shape)}; placement_map is for outlines")
    whole(fingers, "fingers", least=2, most=4)
    mu = number(friction, "friction", least=0)
    word, law = law_of(objective)
    loads = check_space(shape, load, word)
    contacts = shape.contacts(whole(count, "count", least=4, most=2000), friction=mu)
    points = np.array([c.position for c in contacts])
    normals = np.array([c.normal for c in contacts])
    patches = patches_of(np.repeat(points[:, None], 3, axis=1), normals)
    reach = float(np.linalg.norm(points, axis=1).max())
    best = np.full(len(points), np.nan)
    for leaf in np.flatnonzero(patches.tree[:, 0] < 0):
        search = SurfaceSearch(patches, fingers, mu, loads, law, _APART * reach, _TOLERANCE)
        search.keep_one_on(int(leaf))
        search.run(_TOLERANCE, _MOST_BOXES, 0.0, None)
        if search.best < inf:
            best[patches.order[patches.spans[leaf, 0] // 3]] = search.best**law.power
    return SurfaceMap(shape, word, fingers, read_only(points), read_only(normals), read_only(best))
