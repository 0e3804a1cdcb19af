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

All of it is computed in doubles, with margins for rounding, and the verdict says so.
"""

from itertools import pairwise, product
from math import inf
from typing import Any, Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.areas import share_of
from regrasp.verification.verdict import Verification

_ROUNDING = 1e-12  # of sizes that are compared in doubles
_CLOSE = 1e-9


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
    broken = _shapes_wrong(regions)
    if broken:
        return Verification(tuple(broken), inf, -inf, -inf, in_doubles=True)
    for i, patch in enumerate(regions.patches):
        broken += _patch_wrong(regions, i, np.asarray(patch))
    if not 0 <= regions.radius <= float(np.min(regions.radii)) * (1 + _CLOSE):
        broken.append("the radius of all is above that of one of them")
    normals, mu = regions.grasp.normals, regions.grasp.frictions
    along = (regions.forces * normals).sum(axis=-1)
    across = np.linalg.norm(regions.forces - along[..., None] * normals, axis=-1)
    size = np.linalg.norm(regions.forces, axis=-1)
    slack = float((mu * along - across - _ROUNDING * size).min())
    if not slack >= 0:
        broken.append(f"a force at a corner is outside its cone by {-slack:.3g}")
    if not size.max() <= regions.max_force:
        broken.append(f"a force of {size.max():.12g} at a corner is above {regions.max_force:.12g}")
    residual = 0.0
    for load in range(len(regions.loads)):
        residual = max(residual, _residual(regions, load))
        for i in range(len(regions.patches)):
            lacks = _lacks(regions, load, i)
            if not lacks <= regions.moments[load, i]:
                broken.append(
                    f"load {load + 1}: mixtures of the forces of {regions.grasp.names[i]} may lack a torque "
                    f"of {lacks:.6g}, and corners hold {regions.moments[load, i]:.6g} on top"
                )
    if not residual <= float(RESOLUTION):
        broken.append(f"corners are out of equilibrium by {residual:.3g} of the forces")
    used = size > _ROUNDING * regions.max_force
    with np.errstate(divide="ignore", invalid="ignore"):
        room = (mu**2 - (across / along) ** 2)[used]
    least = (np.arctan(mu) - np.arctan2(across, along))[used]
    return Verification(
        tuple(broken), residual, float(least.min(initial=inf)), float(room.min(initial=inf)), in_doubles=True
    )


def _shapes_wrong(regions: FaceRegions) -> list[str]:
    k, loads = len(regions.grasp), np.asarray(regions.loads)
    patches = [np.asarray(p) for p in regions.patches]
    if len(patches) != k or any(p.ndim != 2 or p.shape[1] != 3 or len(p) < 1 for p in patches):
        return ["each contact needs a polygon"]
    if loads.ndim != 2 or loads.shape[1] != 6 or not len(loads):
        return ["there is no load"]
    corners = int(np.prod([len(p) for p in patches]))
    expected = (len(loads), corners, 2 ** sum(len(p) > 1 for p in patches), k, 3)
    arrays = (regions.forces, regions.moments, regions.tilts, regions.focus, regions.radii)
    shapes = (expected, (len(loads), k), (len(loads), k, 3), (len(loads), k), (k,))
    if any(np.asarray(a).shape != s or not np.isfinite(a).all() for a, s in zip(arrays, shapes, strict=True)):
        return ["forces at corners are missing, or what they prove"]
    return []


def _patch_wrong(regions: FaceRegions, i: int, patch: Array) -> list[str]:
    """That a polygon is convex, on faces with the contact's normal, around its place, and wide enough."""
    contact, radius = regions.grasp[i], float(regions.radii[i])
    name, n, r = contact.name, contact.normal, contact.position
    vertices, faces = regions.shape.surface()
    reach = float(np.linalg.norm(vertices, axis=1).max())
    if len(patch) < 3:
        return [] if radius == 0 and np.abs(patch - r).max() <= _CLOSE * reach else [f"{name} has no polygon"]
    sides = np.roll(patch, -1, axis=0) - patch
    lengths = np.linalg.norm(sides, axis=1)
    turns = np.cross(sides, np.roll(sides, -1, axis=0)) @ n
    if (lengths == 0).any() or not ((turns > 0).all() or (turns < 0).all()):
        return [f"the polygon of {name} is not convex"]
    out = np.cross(sides, n) * np.sign(turns[0]) / lengths[:, None]
    heights = ((patch - r) * out).sum(axis=1)
    if not heights.min() > 0 or np.abs((patch - r) @ n).max() > _CLOSE * reach:
        return [f"the polygon of {name} is not around its place"]
    fan = np.array([[patch[0], a, b] for a, b in pairwise(patch[1:])])
    if share_of(fan, np.repeat(n[None], len(fan), axis=0), vertices, faces) < 0:
        return [f"the polygon of {name} is not on faces with its normal"]
    near = heights < radius * (1 - _CLOSE)
    feet = (r + heights[:, None] * out)[near]
    if not all(_at_an_end(foot, n, vertices, faces, reach) for foot in feet):
        return [f"the polygon of {name} is narrower than its radius, and its face does not end there"]
    return []


def _at_an_end(foot: Array, normal: Array, vertices: Array, faces: Any, reach: float) -> bool:
    """Whether a point of a face is on an edge beyond which its plane does not go on."""
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    flat = np.linalg.norm(-cross / np.linalg.norm(cross, axis=1)[:, None] - normal, axis=1) <= _CLOSE
    flat &= np.abs((corners[:, 0] - foot) @ normal) <= _CLOSE * reach
    edges = np.concatenate([faces[flat][:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    _, first, count = np.unique(np.sort(edges, axis=1), axis=0, return_index=True, return_counts=True)
    p, q = np.moveaxis(vertices[edges[first[count == 1]]], 1, 0)
    way = q - p
    share = np.clip(((foot - p) * way).sum(axis=1) / (way**2).sum(axis=1), 0.0, 1.0)
    away = np.linalg.norm(p + share[:, None] * way - foot, axis=1)
    return bool(away.min(initial=inf) <= _CLOSE * reach)


def _residual(regions: FaceRegions, load: int) -> float:
    """How far corners are out of equilibrium, as a part of their largest force and lever."""
    patches, moments = [np.asarray(p) for p in regions.patches], regions.moments[load]
    wide = [i for i, p in enumerate(patches) if len(p) > 1]
    signs = np.array(list(product((-1.0, 1.0), repeat=len(wide))))
    loads = np.repeat(np.asarray(regions.loads)[load][None], len(signs), axis=0)
    loads[:, 3:] += (signs * moments[wide]) @ regions.grasp.normals[wide]
    points = np.array(list(product(*patches)))[:, None]  # (c, 1, k, 3)
    forces = regions.forces[load]
    lever = float(np.linalg.norm(points, axis=-1).max())
    size = max(
        float(np.linalg.norm(forces, axis=-1).max()), float(np.linalg.norm(loads[:, :3], axis=1).max())
    )
    off = np.linalg.norm(forces.sum(axis=2) + loads[:, :3], axis=-1).max()
    twist = np.linalg.norm(np.cross(points, forces).sum(axis=2) + loads[:, 3:], axis=-1).max()
    return float(max(off, twist / lever) / size) if size > 0 else 0.0


def _lacks(regions: FaceRegions, load: int, i: int) -> float:
    """The most torque about a normal that mixtures of a finger's forces may lack, from above [N m]."""
    patches = [np.asarray(p) for p in regions.patches]
    if len(patches[i]) == 1:
        return 0.0
    contact = regions.grasp[i]
    n, r = contact.normal, contact.position
    at = np.array(list(product(*patches)))[:, None, i] - r  # (c, 1, 3)
    f = regions.forces[load][:, :, i]
    along = f @ n
    tilt = regions.tilts[load, i] - (regions.tilts[load, i] @ n) * n
    aside = np.linalg.norm(f - along[..., None] * (n + tilt + regions.focus[load, i] * at), axis=-1)
    aside = aside + _ROUNDING * np.linalg.norm(f, axis=-1)
    wide = float(np.linalg.norm(patches[i][:, None] - patches[i], axis=2).max())
    radius = float(np.linalg.norm(patches[i] - r, axis=1).max())
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = float(np.where(along > 0, aside / along, np.where(aside > 0, inf, 0.0)).max())
    by_slope = float(along.max()) * slope * radius if slope < inf else inf
    return min(by_slope, float(aside.max()) * wide)
