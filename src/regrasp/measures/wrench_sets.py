"""The wrenches that fingers of limited normal force can make, as a support function h(u) = max u . w.

    v_i = G_i' u,   h_i(u) = limit_i max(0, n_i . v_i + mu_i |v_i^t|)
    Linf  each finger's normal force limited:  h = sum h_i
    L1    their sum limited:                   h = max h_i

with torques divided by a length, so that u is a unit vector of one unit. Soft fingers are circular cones of
one tangent more (``regrasp.mechanics.cones``), so nothing changes for them.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp

_NOISE = 1e-14


@dataclass(frozen=True, eq=False)
class WrenchSet:
    """Fingers' wrenches [N]. axes: (n, m) limit_i G_i n_i. tangents: (n, q, m) limit_i mu_i G_i t_ij."""

    axes: Array
    tangents: Array
    total: bool

    @classmethod
    def of(cls, grasp: Grasp, limits: Array, total: bool, length: float) -> "WrenchSet":
        """limits: (n,) of normal forces [N]; total: they limit the sum, not each finger. length: [m]."""
        n, w, cones = len(grasp), grasp.width, grasp.cones
        weight = np.where(np.arange(len(grasp.matrix)) < grasp.dimension, 1.0, 1.0 / length)
        blocks = (cones.matrix * weight[:, None]).T.reshape(n, w, -1) * limits[:, None, None]
        axes = np.einsum("nw,nwm->nm", cones.normals, blocks)
        tangents = np.einsum("n,nqw,nwm->nqm", grasp.frictions, cones.tangents, blocks)
        return cls(axes, tangents, total)

    def support(self, u: Array) -> Array:
        """(k,) h of directions (k, m)."""
        across = np.linalg.norm(np.einsum("nqm,km->nqk", self.tangents, u), axis=1)
        each = np.maximum(self.axes @ u.T + across, 0.0)
        result: Array = each.max(axis=0) if self.total else each.sum(axis=0)
        return result

    @cached_property
    def edges(self) -> Array:
        """(n, 2, 3) wrenches of both edges of planar cones, cut off at the limit."""
        return np.stack([self.axes - self.tangents[:, 0], self.axes + self.tangents[:, 0]], axis=1)

    @cached_property
    def facets(self) -> Array:
        """(k, 3) unit vectors among which are the normals of all facets of a planar grasp's set.

        Linf: a sum of triangles (0, e_-, e_+), whose facets span two of their sides. L1: the hull of their
        corners, whose facets pass through three of these.
        """
        sides = self.edges.reshape(-1, 3)
        if self.total:
            corners = np.vstack([np.zeros(3), sides])
            a, b, c = corners[np.array(list(combinations(range(len(corners)), 3)))].transpose(1, 0, 2)
            normals = np.cross(b - a, c - a)
        else:
            sides = np.vstack([sides, self.edges[:, 1] - self.edges[:, 0]])
            a, b = sides[np.array(list(combinations(range(len(sides)), 2)))].transpose(1, 0, 2)
            normals = np.cross(a, b)
        # of a flat set its plane, and the normals of its sides within it; harmless of others
        plane = np.linalg.svd(sides)[2][-1]
        normals = np.vstack([normals, plane, np.cross(sides, plane)])
        lengths = np.linalg.norm(normals, axis=1)
        kept = normals[lengths > _NOISE * lengths.max()]
        kept = kept / np.linalg.norm(kept, axis=1)[:, None]
        return np.vstack([kept, -kept])
