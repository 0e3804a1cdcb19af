"""The verdict on regions of contacts on flat faces, from forces at all their corners.

Let one finger be anywhere in a polygon with corners v_j, the others where they are, and let forces exist at
every v_j under the load and any torque up to e about this finger's normal n on top of it. For a place p and
a torque t mix the states at the corners with weights c_j >= 0 such that sum c_j N_j (v_j - p) = 0, N_j the
normal part of this finger's force f_j. The mixture acts at p but for a torque about n,
sum c_j (v_j - p) x f_j. With f_j = N_j (n + m + s (v_j - r)) + a_j, m along the face, s a number and r any
point, all parts but the last vanish: of the third (v_j - p) x (v_j - r) the part (v_j - p) x (v_j - p) is
none, and (v_j - p) x (p - r) is mixed to 0. So the torque is at most sum c_j |v_j - p| |a_j|, which is no
more than e if

    max |a_j| times the polygon's width,  or  max N_j max(|a_j| / N_j) times its radius about r,

is: with w_j = c_j N_j / sum c_j N_j, sum w_j |v_j - p| <= sqrt(sum w_j |v_j - r|^2 - |p - r|^2). These
torques over t from -e to e are a convex-valued map of closed graph of [-e, e] into itself, so (Kakutani) one
t is what the mixture lacks, and it holds the load at p. All bounds are convex in forces, so they hold of
mixtures: finger by finger, with the torques of those yet to move on top, corners prove all of the regions.

States at corners are judged as all others, with doubles where these can tell (``corners``); polygons are on
their faces and flat to rounding (``polygons``).
"""

from math import inf
from typing import Any, Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.verification.placed.faces.corners import Corners
from regrasp.verification.placed.faces.polygons import polygon_wrong
from regrasp.verification.placed.regions import above_own
from regrasp.verification.verdict import Verification

_IDLE = 1e-12  # of max_force: a force has no angle


class Solid(Protocol):
    """A mesh."""

    def surface(self) -> tuple[Array, Any]:
        """Vertices relative to the centre of mass [m], and faces."""


class FaceRegions(Protocol):
    """What ``verify`` needs to know of regions on faces, whoever found them; see ``regrasp.FaceRegions``."""

    @property
    def shape(self) -> Solid:
        """The mesh."""

    @property
    def grasp(self) -> Grasp:
        """The contacts."""

    @property
    def patches(self) -> tuple[Array, ...]:
        """Corners of polygons [m]."""

    @property
    def radius(self) -> float:
        """Every finger may be so far off [m]."""

    @property
    def radii(self) -> Array:
        """Each may be so far off [m]."""

    @property
    def max_force(self) -> float:
        """Limit on every force [N]."""

    @property
    def loads(self) -> Array:
        """(l, 6) [N, N m]."""

    @property
    def moments(self) -> Array:
        """(l, k) on top of loads [N m]."""

    @property
    def tilts(self) -> Array:
        """(l, k, 3) m of the forces' directions."""

    @property
    def focus(self) -> Array:
        """(l, k) s of the forces' directions [1/m]."""

    @property
    def forces(self) -> Array:
        """(l, c, s, k, 3) at corners [N]."""


def verify_face_regions(regions: FaceRegions) -> Verification:
    """The verdict: that wherever in their polygons the fingers are, they hold the loads."""
    broken = _shapes_wrong(regions) or above_own(regions.grasp, regions.max_force)
    if broken:
        return Verification(tuple(broken), inf, -inf, -inf)
    vertices, faces = regions.shape.surface()
    for contact, patch, off in zip(
        regions.grasp, regions.patches, np.asarray(regions.radii).tolist(), strict=True
    ):
        broken += polygon_wrong(vertices, np.asarray(faces), contact, np.asarray(patch), off)
    if not 0 <= regions.radius <= float(np.min(regions.radii)):
        broken.append("the radius of all is above that of one of them")
    if broken:
        return Verification(tuple(broken), inf, -inf, -inf)
    residual = 0.0
    for load in range(len(regions.loads)):
        corners = Corners(regions, load)
        off, wrong = corners.wrong()
        residual, broken = max(residual, off), broken + [f"load {load + 1}, {words}" for words in wrong]
        for i, (name, moment) in enumerate(zip(regions.grasp.names, corners.moments, strict=True)):
            lacks = corners.lacks(i)
            if not lacks <= moment:
                broken.append(
                    f"load {load + 1}: mixtures of the forces of {name} may lack a torque of {lacks:.6g}, "
                    f"and corners hold {moment:.6g} on top"
                )
    normals, mu = regions.grasp.normals, regions.grasp.frictions
    along = (regions.forces * normals).sum(axis=-1)
    across = np.linalg.norm(regions.forces - along[..., None] * normals, axis=-1)
    used = np.linalg.norm(regions.forces, axis=-1) > _IDLE * regions.max_force
    with np.errstate(divide="ignore", invalid="ignore"):
        room = (mu**2 - (across / along) ** 2)[used]
    least = (np.arctan(mu) - np.arctan2(across, along))[used]
    return Verification(tuple(broken), residual, float(least.min(initial=inf)), float(room.min(initial=inf)))


def _shapes_wrong(regions: FaceRegions) -> list[str]:
    k, loads = len(regions.grasp), np.asarray(regions.loads)
    patches = [np.asarray(p) for p in regions.patches]
    if len(patches) != k or any(p.ndim != 2 or p.shape[1] != 3 or len(p) < 1 for p in patches):
        return ["each contact needs a polygon"]
    if not all(np.isfinite(a).all() for a in (loads, *patches)):
        return ["loads and polygons must be finite"]
    if loads.ndim != 2 or loads.shape[1] != 6 or not len(loads):
        return ["there is no load"]
    corners = int(np.prod([len(p) for p in patches]))
    expected = (len(loads), corners, 2 ** sum(len(p) > 1 for p in patches), k, 3)
    arrays = (regions.forces, regions.moments, regions.tilts, regions.focus, regions.radii)
    shapes = (expected, (len(loads), k), (len(loads), k, 3), (len(loads), k), (k,))
    if any(np.asarray(a).shape != s or not np.isfinite(a).all() for a, s in zip(arrays, shapes, strict=True)):
        return ["forces at corners are missing, or what they prove"]
    return []
