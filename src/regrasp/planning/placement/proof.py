"""The proof that no placement is better than a bound: boxes that cover all of them, each with a twist."""

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
class PlacementProof(ArrayValue):
    """Boxes of places that cover all placements, each with a load and a twist that bound its placements.

    A place is u, the number of an edge plus the fraction of it passed. A box gives each finger an arc, from a
    u on one side to a u on another. Box 0 is everything; ``children`` says into which boxes one is split:
    fingers are alike, so of c fingers on the same arc 0 to c go left. What bounds the others, and how
    ``regrasp.verify`` checks it, stands in the documentation, page "Where to put the fingers".

    Args:
        vertices: (k, 2) of the polygon, counter-clockwise [m].
        centre_of_mass: (2,) the centre of mass, in the same coordinates [m].
        sides: (m, 3) number of the edge, least and largest u of the stretches on which fingers may be.
        fingers: how many.
        friction: coefficient [-].
        loads: (L, 3) about the centre of mass [N, N m].
        size: of a force, ``normal``, ``force``, or ``margin``: |f| of forces that keep a margin.
        norm: of the sizes, ``sum``, ``squares`` or ``largest``.
        min_distance: between fingers, 0 for none [m].
        bound: no placement holds all loads with a smaller norm [N].
        arcs: (n, fingers, 2) first and last side of each arc.
        ends: (n, fingers, 2) least and largest u of each arc.
        children: (n, 2) the first box that one is split into, and how many; 0 of a box that is not.
        number: (n,) of the load that bounds a box; -1 where its fingers are nearer than ``min_distance``.
        twists: (n, 3) velocity of the centre of mass, then angular velocity.
        control: (k, 4, 2) of a smooth boundary, the control points of its cubic edges, which begin at the
            ``vertices`` [m]; None of a polygon.
        margin: distance of forces from the edges of their cones, of size ``margin`` [N].
        rings: (r,) the first of the vertices of each ring, of the outline and of its holes; None of an
            outline alone.
    """

    vertices: Array
    centre_of_mass: Array
    sides: Array
    fingers: int
    friction: float
    loads: Array
    size: str
    norm: str
    min_distance: float
    bound: float
    arcs: np.ndarray
    ends: Array
    children: np.ndarray
    number: np.ndarray
    twists: Array
    control: Array | None = None
    margin: float = 0.0
    rings: np.ndarray | None = None

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
        given = {n: v for n, v in values if v is not None and (n != "margin" or v)}
        return {n: v.tolist() if isinstance(v, np.ndarray) else v for n, v in given.items()}

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
        names = [f.name for f in fields(cls) if f.name not in ("control", "margin", "rings")]
        given = entries(data, "a proof", [*names, "digest"], ("control", "margin", "rings"))
        control = given.get("control")
        k = whole(given["fingers"], "fingers", least=1)
        children = _integers(given["children"], "children", (None, 2))
        n = len(children)
        proof = cls(
            array(given["vertices"], "vertices", (None, 2)),
            array(given["centre_of_mass"], "centre_of_mass", (2,)),
            array(given["sides"], "sides", (None, 3)),
            k,
            number(given["friction"], "friction", least=0),
            array(given["loads"], "loads", (None, 3)),
            choice(given["size"], "size", ("normal", "force", "margin")),
            choice(given["norm"], "norm", ("sum", "squares", "largest")),
            number(given["min_distance"], "min_distance", least=0),
            number(given["bound"], "bound", least=0),
            _integers(given["arcs"], "arcs", (n, k, 2)),
            array(given["ends"], "ends", (n, k, 2)),
            children,
            _integers(given["number"], "number", (n,)),
            array(given["twists"], "twists", (n, 3)),
            None if control is None else array(control, "control", (None, 4, 2)),
            number(given.get("margin", 0.0), "margin", least=0),
            None if given.get("rings") is None else _integers(given["rings"], "rings", (None,)),
        )
        if given["digest"] != proof.digest:
            raise InvalidInput("the digest of a proof does not fit its numbers: one of them was changed")
        return proof

    def __repr__(self) -> str:
        return f"PlacementProof(bound {self.bound:.6g}, {self.fingers} fingers, {self.leaves} boxes)"


def _integers(value: Any, what: str, shape: tuple[int | None, ...]) -> np.ndarray:
    found = array(value, what, shape)
    whole_numbers = found.astype(np.int64)
    if (whole_numbers != found).any():
        raise InvalidInput(f"{what} must be whole numbers")
    whole_numbers.setflags(write=False)
    return whole_numbers
