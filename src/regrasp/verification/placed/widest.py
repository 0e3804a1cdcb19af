"""The proof that no arcs around the places of regions on straight sides are all longer than a bound.

Arcs that are all W long or longer, around all places and each on its side, contain those that begin where
they do and are W long, or end at the place if that is farther. Of all that begin in a box of starts, what is
between the last start and W after the first, or the place, is common; where a placement there fails, none of
them holds. It fails where a load does more work along a twist than forces below the limit take up.
"""

from fractions import Fraction
from math import inf
from types import SimpleNamespace
from typing import Any, Protocol, cast

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.placed.curved_regions import covered
from regrasp.verification.placed.protocol import Proof
from regrasp.verification.placed.roots import root_above
from regrasp.verification.placed.straight import StraightEdges

_SLACK = 2.0**-36  # of u, by which a place may be elsewhere than its arc length says
_Shapes = tuple[tuple[int, ...], ...]


class Widest(Protocol):
    """What ``verify`` needs to know of such a proof, whoever made it; see ``WidestProof``."""

    @property
    def bound(self) -> float:
        """No arcs are all longer [m]."""

    @property
    def places(self) -> Array:
        """(k,) u that arcs are around."""

    @property
    def starts(self) -> Array:
        """(c, k, 2) boxes of u where arcs begin."""

    @property
    def at(self) -> Array:
        """(c, k) u of placements that fail."""

    @property
    def loads(self) -> Array:
        """(c, 3) which they do not hold."""

    @property
    def twists(self) -> Array:
        """(c, 3) that show it."""


def widest_wrong(proof: Widest, regions: Any, rings: list[Array], edges: list[int]) -> list[str]:
    """What is wrong with a proof about regions whose fingers are on some edges of rings, in words."""
    k, width, count = len(edges), proof.bound, len(np.asarray(proof.starts))
    arrays = [np.asarray(a) for a in (proof.places, proof.starts, proof.at, proof.loads, proof.twists)]
    shapes: _Shapes = ((k,), (count, k, 2), (count, k), (count, 3), (count, 3))
    if any(a.shape != shape for a, shape in zip(arrays, shapes, strict=True)):
        return ["the proof of the widest has parts missing"]
    finite = 0 <= regions.max_force < inf and all(np.isfinite(a).all() for a in arrays)
    if not (0 < width < inf and finite):
        return ["the proof of the widest has numbers that are none to compute with"]
    places, cells, at, loads, twists = (a.tolist() for a in arrays)
    vertices = np.concatenate(rings)
    straight = StraightEdges(cast(Proof, SimpleNamespace(
        vertices=vertices, centre_of_mass=np.zeros(2), rings=np.cumsum([0, *map(len, rings[:-1])]),
        friction=float(np.max(regions.grasp.frictions)), size="force", bound=0.0, margin=0.0,
    )))  # fmt: skip
    squares = [sum((x * x for x in straight.along[edge]), Fraction(0)) for edge in edges]
    lengths = [root_above(square) for square in squares]
    begin = np.concatenate([[0.0], np.cumsum([float(1 / per) for per in straight.per])])
    for u, e, s, length in zip(places, edges, np.asarray(regions.places).tolist(), lengths, strict=True):
        off = e + (s % float(begin[-1]) - float(begin[e])) / float(length) - u
        if not (abs(off) <= _SLACK and e <= u <= e + 1):
            return ["the proof of the widest is about arcs around other places"]
    if any(Fraction(width) ** 2 >= square for square in squares):
        return []  # no arc on that side is longer
    ends = [
        max(min(u, e + 1 - width / float(length) * (1 - _SLACK)), e)
        for u, e, length in zip(places, edges, lengths, strict=True)
    ]
    if not covered(arrays[1], np.column_stack([edges, ends]).astype(float)):
        return ["the boxes of the proof of the widest do not cover all starts of arcs"]
    shown = {tuple(state.load.vector.tolist()) for state in regions.corners}
    for number in range(count):
        which, load = f"box {number + 1} of the proof of the widest", loads[number]
        if tuple(load) not in shown:
            return [f"{which} is about a load that is not to be held"]
        sides = zip(cells[number], at[number], places, edges, lengths, strict=True)
        if not all(
            e <= u <= e + 1
            and hi <= u
            and (u <= place or (Fraction(u) - Fraction(lo)) * length <= Fraction(width))
            for (lo, hi), u, place, e, length in sides
        ):
            return [f"the placement of {which} is not in all of its arcs"]
        y = [Fraction(x) for x in twists[number]]
        work = -sum((Fraction(w) * x for w, x in zip(load, y, strict=True)), Fraction(0))
        shares = [Fraction(u) - e for u, e in zip(at[number], edges, strict=True)]
        most = sum((straight.most(e, t, t, y) for e, t in zip(edges, shares, strict=True)), Fraction(0))
        if not work > Fraction(regions.max_force) * most:
            return [f"the placement of {which} may hold its load"]
    return []
