"""The proof that no placement is better than a bound: boxes that cover all of them, each with a twist."""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, array, choice, number, whole
from regrasp.planning.placement.proofs.box_proof import BoxProof, integers


@dataclass(frozen=True, eq=False, repr=False)
class PlacementProof(BoxProof):
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
        bound: no placement holds all loads with a smaller norm [N]; of size ``margin`` nor with this one.
        arcs: (n, fingers, 2) first and last side of each arc.
        ends: (n, fingers, 2) least and largest u of each arc.
        children: (n, 2) the first box that one is split into, and how many; 0 of a box that is not.
        number: (n,) of the load that bounds a box; -1 where its fingers are nearer than ``min_distance``,
            -2 - r where row r of ``tied`` bounds it.
        twists: (n, 3) velocity of the centre of mass, then angular velocity.
        control: (k, 4, 2) of a smooth boundary, the control points of its cubic edges, which begin at the
            ``vertices`` [m]; None of a polygon.
        margin: distance of forces from the edges of their cones, of size ``margin`` [N].
        rings: (r,) the first of the vertices of each ring, of the outline and of its holes; None of an
            outline alone.
        pairs: (q, 2) boxes that two twists bound together, and the second one's load; None for none.
        seconds: (q, 3) their second twists.
        tied: (r, 3 L + (L - 1) T) a twist for each load, then factors of the T ties of each load after the
            first; None without. Forces are then those of fingers of equal stiffness that stay where they were
            put for the first load: a bound of what is withstood, and of nothing else.
        movers: (q, 2) boxes that twists exclude which move with the fingers, and a load of one of these; each
            box has all of them in turn. None for none.
        motions: (q, 3 + 2 fingers) of each load, its twist with all fingers at the beginning of their arcs,
            then by how much each finger adds to the one and to the other velocity on its way to the end. Of a
            smooth boundary (q, (3 + fingers) m) the m terms of polynomials of degree 2 in how far along its
            part each finger is, from 0 to 1: of both velocities, the angular one, and a bound of what each
            finger does along them; 1 first, then each place, then each product of two.
        max_force: of every finger, which the proof counts on [N]; None for none.
        min_normal: with which every finger pushes at the least, which it counts on, too [N].
        turned: whether the boundary is a circle about the centre of mass, or nearly, and the proof is of all
            loads together that turns make of ``loads``: in box 0 the first finger then is at the beginning.
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
    pairs: np.ndarray | None = None
    seconds: Array | None = None
    tied: Array | None = None
    movers: np.ndarray | None = None
    motions: Array | None = None
    max_force: float | None = None
    min_normal: float = 0.0
    turned: bool = False
    by_side: np.ndarray | None = None
    side_twists: Array | None = None

    @classmethod
    def _checked(cls, given: dict[str, Any]) -> Self:
        control = given.get("control")
        k = whole(given["fingers"], "fingers", least=1)
        children = integers(given["children"], "children", (None, 2))
        n = len(children)
        return cls(
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
            integers(given["arcs"], "arcs", (n, k, 2)),
            array(given["ends"], "ends", (n, k, 2)),
            children,
            integers(given["number"], "number", (n,)),
            array(given["twists"], "twists", (n, 3)),
            None if control is None else array(control, "control", (None, 4, 2)),
            number(given.get("margin", 0.0), "margin", least=0),
            None if given.get("rings") is None else integers(given["rings"], "rings", (None,)),
            None if given.get("pairs") is None else integers(given["pairs"], "pairs", (None, 2)),
            None if given.get("seconds") is None else array(given["seconds"], "seconds", (None, 3)),
            None if given.get("tied") is None else array(given["tied"], "tied", (None, None)),
            None if given.get("movers") is None else integers(given["movers"], "movers", (None, 2)),
            None if given.get("motions") is None else array(given["motions"], "motions", (None, None)),
            None if given.get("max_force") is None else number(given["max_force"], "max_force", above=0),
            number(given.get("min_normal", 0.0), "min_normal", least=0),
            _flag(given.get("turned", False)),
            None if given.get("by_side") is None else integers(given["by_side"], "by_side", (None, 2)),
            None
            if given.get("side_twists") is None
            else array(given["side_twists"], "side_twists", (None, 3)),
        )


def _flag(value: Any) -> bool:
    if not isinstance(value, bool):
        raise InvalidInput(f"turned must be true or false, got {shown(value)}")
    return value
