"""The proof that no placement on a surface is better than a bound: boxes of patches, each with a twist."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from regrasp.mechanics.checks import Array, array, choice, number, whole
from regrasp.planning.placement.proofs.box_proof import BoxProof, integers


@dataclass(frozen=True, eq=False, repr=False)
class PatchProof(BoxProof):
    """Boxes of patches that cover all placements, each with a load and a twist that bound its placements.

    Patch 0 is all triangles; a group is halved into groups, a triangle across an edge, again and
    again. Box 0 gives every finger patch 0; fingers are alike, so of c fingers on the patch that is halved
    0 to c go to its first half. Why a twist bounds a box stands in the documentation, page "Where to put the
    fingers".

    Args:
        corners: (m, 3, 3) of triangles, relative to the centre of mass [m].
        normals: (m, 3) inward.
        fingers: how many.
        friction: coefficient [-].
        loads: (L, 6) about the centre of mass [N, N m].
        size: of a force, ``normal`` or ``force``.
        norm: of the sizes, ``sum``, ``squares`` or ``largest``.
        min_distance: between fingers, 0 for none [m].
        bound: no placement holds all loads with a smaller norm [N].
        spans: (p, 2) the first triangle of each group and how many.
        halves: (q, 3) the two halves of each patch, -1 for none, and the edge across which a triangle is
            halved: from that corner to the next; the first half keeps the corner, both the third one.
        boxes: (n, fingers) patches.
        children: (n, 2) the first box that one is split into, and how many; 0 of a box that is not.
        number: (n,) of the load that bounds a box; -1 where its fingers are nearer than ``min_distance``,
            -2 - r where row r of ``together`` bounds it.
        twists: (n, 6) velocity of the centre of mass, then angular velocity.
        together: (r, L, 6) a twist for each load, which bound the largest force together; None for none.
    """

    corners: Array
    normals: Array
    fingers: int
    friction: float
    loads: Array
    size: str
    norm: str
    min_distance: float
    bound: float
    spans: np.ndarray
    halves: np.ndarray
    boxes: np.ndarray
    children: np.ndarray
    number: np.ndarray
    twists: Array
    together: Array | None = None

    @classmethod
    def _checked(cls, given: dict[str, Any]) -> Self:
        k = whole(given["fingers"], "fingers", least=1)
        together = given.get("together")
        return cls(
            array(given["corners"], "corners", (None, 3, 3)),
            array(given["normals"], "normals", (None, 3)),
            k,
            number(given["friction"], "friction", least=0),
            array(given["loads"], "loads", (None, 6)),
            choice(given["size"], "size", ("normal", "force")),
            choice(given["norm"], "norm", ("sum", "squares", "largest")),
            number(given["min_distance"], "min_distance", least=0),
            number(given["bound"], "bound", least=0),
            integers(given["spans"], "spans", (None, 2)),
            integers(given["halves"], "halves", (None, 3)),
            integers(given["boxes"], "boxes", (None, k)),
            integers(given["children"], "children", (None, 2)),
            integers(given["number"], "number", (None,)),
            array(given["twists"], "twists", (None, 6)),
            None if together is None else array(together, "together", (None, None, 6)),
        )
