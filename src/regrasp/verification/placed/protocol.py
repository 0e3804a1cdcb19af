"""What a proof about placements is to those who check it."""

from fractions import Fraction
from typing import Any, Protocol

import numpy as np

from regrasp.mechanics.checks import Array

Point = tuple[Fraction, Fraction]


class Proof(Protocol):
    """What is needed to know of a proof, whoever made it; the words are those of ``PlacementProof``."""

    @property
    def vertices(self) -> Array:
        """(k, 2) of the polygon [m]."""

    @property
    def centre_of_mass(self) -> Array:
        """(2,) [m]."""

    @property
    def sides(self) -> Array:
        """(m, 3) edge, least and largest u."""

    @property
    def fingers(self) -> int:
        """How many."""

    @property
    def friction(self) -> float:
        """Coefficient [-]."""

    @property
    def loads(self) -> Array:
        """(L, 3) [N, N m]."""

    @property
    def size(self) -> str:
        """``normal``, ``force`` or ``margin``."""

    @property
    def norm(self) -> str:
        """``sum``, ``squares`` or ``largest``."""

    @property
    def min_distance(self) -> float:
        """Between fingers [m]."""

    @property
    def bound(self) -> float:
        """No placement is better."""

    @property
    def arcs(self) -> Any:
        """Of each finger."""

    @property
    def ends(self) -> Array:
        """(n, fingers, 2) u."""

    @property
    def children(self) -> Any:
        """(n, 2) first box and how many."""

    @property
    def number(self) -> Any:
        """(n,) of the load, or -1."""

    @property
    def twists(self) -> Array:
        """(n, 3)."""

    @property
    def control(self) -> Array | None:
        """(k, 4, 2) control points of the edges where they are cubics [m]."""

    @property
    def rings(self) -> Any:
        """(r,) the first vertex of each ring of a polygon with holes, else None."""

    @property
    def margin(self) -> float:
        """Distance of forces from the edges of their cones, where the size is ``margin`` [N]."""


def after_each(count: int, rings: Any) -> np.ndarray:
    """(k,) which vertex comes after each of so many on its ring."""
    parts = np.split(np.arange(count), [] if rings is None else np.asarray(rings)[1:])
    return np.concatenate([np.roll(part, -1) for part in parts])
