"""The proof that no placement on a surface is better than a bound: boxes of patches, each with a twist."""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from hashlib import sha256
from typing import Any, Self

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, array, choice, number, whole
from regrasp.mechanics.plain import entries
from regrasp.mechanics.value import ArrayValue


@dataclass(frozen=True, eq=False, repr=False)
class PatchProof(ArrayValue):
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
        number: (n,) of the load that bounds a box; -1 where its fingers are nearer than ``min_distance``.
        twists: (n, 6) velocity of the centre of mass, then angular velocity.
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

    @property
    def digest(self) -> str:
        """Of all of its numbers: one that is touched no longer fits."""
        return sha256(repr(self._plain()).encode()).hexdigest()

    @property
    def leaves(self) -> int:
        """Boxes that are not split: what is excluded one by one."""
        return int((self.children[:, 1] == 0).sum())

    def _plain(self) -> dict[str, Any]:
        values = ((f.name, getattr(self, f.name)) for f in fields(self))
        return {n: v.tolist() if isinstance(v, np.ndarray) else v for n, v in values}

    def to_dict(self) -> dict[str, Any]:
        """The proof as plain data, which JSON can hold; ``from_dict`` gives back the equal proof."""
        return {**self._plain(), "digest": self.digest}

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Self:
        """The proof of plain data; whether it proves anything ``regrasp.verify`` says.

        Args:
            data: what ``to_dict`` returned, or JSON made of it.

        Raises:
            InvalidInput: For other keys, shapes and types, and for numbers that the digest does not fit.
        """
        given = entries(data, "a proof", [*(f.name for f in fields(cls)), "digest"])
        k = whole(given["fingers"], "fingers", least=1)
        proof = cls(
            array(given["corners"], "corners", (None, 3, 3)),
            array(given["normals"], "normals", (None, 3)),
            k,
            number(given["friction"], "friction", least=0),
            array(given["loads"], "loads", (None, 6)),
            choice(given["size"], "size", ("normal", "force")),
            choice(given["norm"], "norm", ("sum", "squares", "largest")),
            number(given["min_distance"], "min_distance", least=0),
            number(given["bound"], "bound", least=0),
            _integers(given["spans"], "spans", (None, 2)),
            _integers(given["halves"], "halves", (None, 3)),
            _integers(given["boxes"], "boxes", (None, k)),
            _integers(given["children"], "children", (None, 2)),
            _integers(given["number"], "number", (None,)),
            array(given["twists"], "twists", (None, 6)),
        )
        if given["digest"] != proof.digest:
            raise InvalidInput("the digest of a proof does not fit its numbers: one of them was changed")
        return proof

    def __repr__(self) -> str:
        return f"PatchProof(bound {self.bound:.6g}, {self.fingers} fingers, {self.leaves} boxes)"


def _integers(value: Any, what: str, shape: tuple[int | None, ...]) -> np.ndarray:
    found = array(value, what, shape)
    whole_numbers = found.astype(np.int64)
    if (whole_numbers != found).any():
        raise InvalidInput(f"{what} must be whole numbers")
    whole_numbers.setflags(write=False)
    return whole_numbers
