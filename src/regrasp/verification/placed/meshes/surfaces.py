"""The check of a proof that no placement of fingers on the faces of a mesh is better than a bound.

Boxes of patches cover all placements, and a twist y = (v_0, omega) excludes each that is not split. A finger
at p with inward normal n does along y the work v . f, v = v_0 + omega x p, which is affine in p. The most of
it over forces of its cone of size 1, sigma(v), is convex in v, and so largest at a corner of its patch:

    sigma = max(0, n.v + mu |v_t|)                        size n.f
    sigma = |v| inside the cone, else max(0, n.v + mu |v_t|) / sqrt(1 + mu^2)     size |f|

Then (-w) . y <= N*(largest sigma of each finger) N(sizes), as in the plane (``placements``). Doubles decide
where more than all of their rounding is left, and rationals, roots rounded up, where it is not.
"""

from fractions import Fraction
from itertools import product
from math import inf
from typing import Any, Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.meshes.patches import Patches
from regrasp.verification.placed.meshes.together import together_wrong
from regrasp.verification.placed.meshes.work import ROUNDING, SMALL, sigma_above, sigmas
from regrasp.verification.placed.roots import root_above

_AT_A_TIME = 4096
_MOST = 1e150  # m: squares of more are no doubles


class SurfaceProof(Protocol):
    """What is needed to know of a proof on a surface, whoever made it, as of ``PatchProof``."""

    corners: Array
    normals: Array
    fingers: int
    friction: float
    loads: Array
    size: str
    norm: str
    min_distance: float
    bound: float
    spans: Any
    halves: Any
    boxes: Any
    children: Any
    number: Any
    twists: Array
    together: Array | None


def check_surface_proof(proof: SurfaceProof) -> list[str]:
    """What is wrong with the tree of boxes or with what excludes them, in words; nothing for a proof."""
    try:
        if broken := _shapes(proof):
            return broken
        patches = Patches(proof)
        return patches.wrong() or _boxes_wrong(proof) or _exclusions_wrong(proof, patches)
    except (ArithmeticError, AttributeError, LookupError, TypeError, ValueError):
        return ["proof: its numbers are none to compute with"]


def _shapes(proof: SurfaceProof) -> list[str]:
    m, n, k = len(proof.normals), len(proof.children), proof.fingers
    wanted = [
        (np.shape(proof.corners), (m, 3, 3)), (np.shape(proof.normals), (m, 3)),
        (np.shape(proof.loads), (len(proof.loads), 6)),
        (np.shape(proof.spans), (len(proof.spans), 2)), (np.shape(proof.halves), (len(proof.halves), 3)),
        (np.shape(proof.boxes), (n, k)), (np.shape(proof.children), (n, 2)),
        (np.shape(proof.number), (n,)), (np.shape(proof.twists), (n, 6)),
    ]  # fmt: skip
    if any(found != shape for found, shape in wanted) or not (n and k and len(proof.loads)):
        return ["proof: its arrays do not have the shapes that they must have"]
    numbers = (proof.corners, proof.normals, proof.loads, proof.twists, proof.bound)
    if not all(np.isfinite(a).all() for a in numbers) or not 0 <= proof.friction < inf:
        return ["proof: its numbers must be finite, and friction 0 or more"]
    if proof.size not in ("normal", "force") or proof.norm not in ("sum", "squares", "largest"):
        return ["proof: size or norm has no meaning"]
    if not 0 <= proof.min_distance < inf or proof.bound < 0:
        return ["proof: min_distance and bound must be 0 or more"]
    if np.abs(proof.corners).max(initial=0.0) > _MOST:
        return [f"proof: its corners must be within {_MOST:g} m"]
    with np.errstate(over="ignore"):
        lengths = np.linalg.norm(proof.normals, axis=1)
    return [] if (np.abs(lengths - 1) < ROUNDING / 2).all() else ["proof: normals must be of length 1"]


def _boxes_wrong(proof: SurfaceProof) -> list[str]:
    """That the boxes are a tree, and that each is covered by those it is split into."""
    boxes, children, halves = (np.asarray(a) for a in (proof.boxes, proof.children, proof.halves))
    n = len(boxes)
    if boxes.min() < 0 or boxes.max() >= len(halves) or boxes[0].any():
        return ["proof: box 0 must give every finger the whole surface, and all boxes patches"]
    parents = np.flatnonzero(children[:, 1])
    first, count = children[parents].T
    if (first < 1).any() or (count < 1).any() or (count > n - first).any():
        return ["proof: the boxes are no tree"]
    inside = [np.arange(a, a + c) for a, c in children[parents].tolist()]
    everyone = np.sort(np.concatenate([*inside, np.zeros(0, int)]))
    if not np.array_equal(everyone, np.arange(1, n)):
        return ["proof: the boxes are no tree"]
    for c in np.unique(count).tolist():
        these = parents[count == c]
        whole = boxes[these]
        parts = boxes[children[these, 0][:, None] + np.arange(c)]
        split = parts[:, 0] != whole
        at = split.argmax(axis=1)
        patch = np.take_along_axis(whole, at[:, None], axis=1)
        left, right = halves[patch, 0], halves[patch, 1]
        place = np.cumsum(split, axis=1) - 1
        good = (split.sum(axis=1) == c - 1) & (~split | (whole == patch)).all(axis=1)
        for number in range(c):
            expected = np.where(split, np.where(place < c - 1 - number, left, right), whole)
            good &= (parts[:, number] == expected).all(axis=1)
        if c < 2 or not good.all():
            box = these[int(good.argmin())]
            return [f"proof: box {box} is not covered by the boxes it is split into"]
    return []


def _exclusions_wrong(proof: SurfaceProof, patches: Patches) -> list[str]:
    boxes, number = np.asarray(proof.boxes), np.asarray(proof.number)
    leaves = np.flatnonzero(np.asarray(proof.children)[:, 1] == 0)
    near = leaves[number[leaves] == -1]
    for box in near.tolist():
        if not _near(proof, patches, boxes[box]):
            return [f"proof: fingers of box {box} may be far enough apart"]
    if broken := together_wrong(proof, patches, leaves[number[leaves] < -1]):
        return broken
    rest = leaves[number[leaves] >= 0]
    if (number[rest] >= len(proof.loads)).any():
        return ["proof: a box has no load"]
    if proof.bound == 0 or not len(rest):
        return []
    with np.errstate(all="ignore"):
        clear = _clear(proof, patches, rest)
    for box in rest[~clear].tolist():
        if not _excluded(proof, patches, box):
            return [f"proof: the twist of box {box} does not exclude it"]
    return []


def _clear(proof: SurfaceProof, patches: Patches, rest: np.ndarray) -> np.ndarray:
    """Which boxes doubles show to be excluded."""
    reach, boxes = float(np.linalg.norm(proof.corners, axis=2).max()), np.asarray(proof.boxes)
    y, w = proof.twists[rest], np.asarray(proof.loads)[np.asarray(proof.number)[rest]]
    most = np.zeros((len(rest), proof.fingers))
    for finger in range(proof.fingers):  # boxes that share a patch together
        order = np.argsort(boxes[rest, finger], kind="stable")
        here = boxes[rest[order], finger]
        for group in np.split(order, np.flatnonzero(np.diff(here)) + 1):
            points, normals = patches.rows(int(boxes[rest[group[0]], finger]))
            for some in np.split(group, range(_AT_A_TIME, len(group), _AT_A_TIME)):
                most[some, finger] = sigmas(proof, y[some], points, normals).max(axis=1)
    speed = np.linalg.norm(y[:, :3], axis=1) + np.linalg.norm(y[:, 3:], axis=1) * reach
    room = ROUNDING * (1 + proof.friction) * speed
    most += room[:, None]
    dual = most.max(axis=1) if proof.norm == "sum" else most.sum(axis=1)
    if proof.norm == "squares":
        dual = np.sqrt((most**2).sum(axis=1))
    terms = -w * y
    work = terms.sum(axis=1) - ROUNDING * np.abs(terms).sum(axis=1)
    told = np.minimum(speed, work) > SMALL
    return np.asarray(told & (work > proof.bound * dual * (1 + ROUNDING)))


def _excluded(proof: SurfaceProof, patches: Patches, box: int) -> bool:
    """The same of one box in rationals."""
    y = [Fraction(c) for c in proof.twists[box].tolist()]
    w = proof.loads[int(proof.number[box])].tolist()
    work = -sum((Fraction(a) * b for a, b in zip(w, y, strict=True)), start=Fraction(0))
    most = []
    for patch in proof.boxes[box].tolist():
        most.append(max(sigma_above(proof, y, *corner) for corner in patches.exactly(patch)))
    if proof.norm == "sum":
        dual = max(most)
    elif proof.norm == "largest":
        dual = sum(most, start=Fraction(0))
    else:
        dual = root_above(sum((s * s for s in most), start=Fraction(0)))
    return work > Fraction(proof.bound) * dual


def _near(proof: SurfaceProof, patches: Patches, box: Array) -> bool:
    """Whether two fingers are nearer than they must be, wherever they are on their patches."""
    rows = [patches.rows(patch)[0] for patch in box.tolist()]
    reach = float(np.abs(proof.corners).max())
    for i, one in enumerate(rows):
        for j, other in enumerate(rows[:i]):
            far = np.linalg.norm(one[:, None] - other[None], axis=2).max()
            if far < proof.min_distance + ROUNDING * reach and _nearer(
                proof, patches, int(box[i]), int(box[j])
            ):
                return True
    return False


def _nearer(proof: SurfaceProof, patches: Patches, one: int, other: int) -> bool:
    """The same of two in rationals."""
    least2 = Fraction(proof.min_distance) ** 2
    each = [[p for p, _ in patches.exactly(patch)] for patch in (one, other)]
    return all(sum((a - b) ** 2 for a, b in zip(p, q, strict=True)) < least2 for p, q in product(*each))


def touches(proof: SurfaceProof, contact: Contact) -> bool:
    """Whether a contact is on one of the triangles, with its inward normal."""
    corners, n = np.asarray(proof.corners), np.asarray(proof.normals)
    reach = float(np.linalg.norm(corners, axis=2).max())
    facing = np.linalg.norm(n - contact.normal, axis=1) <= 4 * float(RESOLUTION)
    return bool((away(corners[facing], contact.position) <= float(RESOLUTION) * reach).any())


def away(corners: Array, point: Array) -> Array:
    """(m,) distances of a point from triangles (m, 3, 3)."""
    a, b, c = (corners[:, i] for i in range(3))
    normal = np.cross(b - a, c - a)
    square = (normal**2).sum(axis=1)
    height = ((point - a) * normal).sum(axis=1) / np.sqrt(square)
    inside = np.ones(len(corners), bool)
    away = np.full(len(corners), inf)
    for p, q in ((a, b), (b, c), (c, a)):
        side = q - p
        inside &= (np.cross(side, point - p) * normal).sum(axis=1) >= 0
        t = np.clip(((point - p) * side).sum(axis=1) / (side**2).sum(axis=1), 0, 1)
        away = np.minimum(away, np.linalg.norm(p + t[:, None] * side - point, axis=1))
    return np.where(inside, np.abs(height), away)
