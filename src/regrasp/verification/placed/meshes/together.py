"""The check of boxes of patches that twists of all loads exclude together, where each force is limited.

A twist y_l for each load w_l, and forces of a placement p in the box, of sizes up to T under every load, give

    sum_l (-w_l) . y_l = sum_l sum_i v_l(p_i) . f_li <= T sum_i max_c sum_l sigma(v_l(c)),

c the corners of the patch of finger i: the sum over l is convex in p_i. So T is more than the bound where the
left side is more than the bound times the sum on the right.
"""

from fractions import Fraction
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.meshes.patches import Corner, Patches
from regrasp.verification.placed.meshes.work import ROUNDING, SMALL, sigma_above, sigmas


def together_wrong(proof: Any, patches: Patches, boxes: np.ndarray) -> list[str]:
    """What is wrong with boxes whose twists are rows of ``together``, in words."""
    if not len(boxes):
        return []
    twists = proof.together
    if twists is None:
        return ["proof: a box has no load"]
    if proof.norm != "largest":
        return ["proof: loads are taken together for a largest force alone"]
    if np.shape(twists)[1:] != (len(proof.loads), 6):
        return ["proof: its arrays do not have the shapes that they must have"]
    at = -2 - np.asarray(proof.number)[boxes]
    if (at >= len(twists)).any():
        return ["proof: a box has no load"]
    if not np.isfinite(twists).all():
        return ["proof: its numbers must be finite, and friction 0 or more"]
    if proof.bound == 0:
        return []
    reach = float(np.linalg.norm(proof.corners, axis=2).max())
    for box, row in zip(boxes.tolist(), at.tolist(), strict=True):
        on = [int(patch) for patch in proof.boxes[box]]
        with np.errstate(all="ignore"):
            clear = _is_clear(proof, np.asarray(twists[row]), list(map(patches.rows, on)), reach)
        if not clear and not _is_excluded(proof, twists[row], [patches.exactly(patch) for patch in on]):
            return [f"proof: the twists of box {box} do not exclude it"]
    return []


def _is_clear(proof: Any, y: Array, patches: list[tuple[Array, Array]], reach: float) -> bool:
    """Whether doubles show it."""
    speed = np.linalg.norm(y[:, :3], axis=1) + np.linalg.norm(y[:, 3:], axis=1) * reach
    size = float(speed.sum())
    room = ROUNDING * (1 + proof.friction) * size
    dual = sum(float(sigmas(proof, y, *patch).sum(axis=0).max()) + room for patch in patches)
    terms = -np.asarray(proof.loads) * y
    work = float(terms.sum()) - ROUNDING * float(np.abs(terms).sum())
    return bool(min(size, work) > SMALL and work > proof.bound * dual * (1 + ROUNDING))


def _is_excluded(proof: Any, y: Array, patches: list[list[Corner]]) -> bool:
    """The same in rationals, roots rounded up."""
    twists = [[Fraction(c) for c in twist] for twist in y.tolist()]
    loads = np.asarray(proof.loads).tolist()
    work = -sum(
        (
            Fraction(a) * b
            for w, twist in zip(loads, twists, strict=True)
            for a, b in zip(w, twist, strict=True)
        ),
        start=Fraction(0),
    )
    dual = Fraction(0)
    for corners in patches:
        dual += max(sum(sigma_above(proof, twist, p, n) for twist in twists) for p, n in corners)
    return work > Fraction(proof.bound) * dual
