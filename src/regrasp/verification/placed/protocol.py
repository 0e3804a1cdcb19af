"""What proofs about placements, and grasps chosen by them, are to those who check them."""

from fractions import Fraction
from typing import Any, Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState

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
    def pairs(self) -> Any:
        """(q, 2) boxes with a second twist, and its load; None for none."""

    @property
    def seconds(self) -> Array | None:
        """(q, 3)."""

    @property
    def control(self) -> Array | None:
        """(k, 4, 2) control points of the edges where they are cubics [m]."""

    @property
    def rings(self) -> Any:
        """(r,) the first vertex of each ring of a polygon with holes, else None."""

    @property
    def margin(self) -> float:
        """Distance of forces from the edges of their cones, where the size is ``margin`` [N]."""

    @property
    def tied(self) -> Array | None:
        """(r, 3 L + (L - 1) T) duals of boxes that all loads exclude together."""

    @property
    def movers(self) -> Any:
        """(q, 2) boxes excluded by twists that move with the fingers, and their loads; None for none."""

    @property
    def motions(self) -> Array | None:
        """(q, c) of each load, the twist at the beginning of all arcs, then what fingers add.

        On curves terms of polynomials in the places, of the twist and of what bounds each finger's work.
        """

    @property
    def by_side(self) -> Any:
        """(q, 2) boxes whose twists exclude each side of a finger, and a load; None for none."""

    @property
    def side_twists(self) -> Array | None:
        """(q, 3) these twists."""

    @property
    def turned(self) -> bool:
        """Whether loads and boundary are the same after every turn, and the first finger stays."""

    @property
    def max_force(self) -> float | None:
        """Of every finger [N]; None for none."""

    @property
    def min_normal(self) -> float:
        """With which every finger pushes at the least [N]."""


def velocity(y: list[Fraction], point: Point) -> Point:
    """Of a point, along a twist."""
    return y[0] - y[2] * point[1], y[1] + y[2] * point[0]


def after_each(count: int, rings: Any) -> np.ndarray:
    """(k,) which vertex comes after each of so many on its ring."""
    parts = np.split(np.arange(count), [] if rings is None else np.asarray(rings)[1:])
    return np.concatenate([np.roll(part, -1) for part in parts])


class Shape(Protocol):
    """An outline as ``verify`` sees it."""

    def polygon(self) -> Array:
        """(k, 2) vertices relative to the centre of mass [m]."""

    def hole_polygons(self) -> tuple[Array, ...]:
        """(k, 2) vertices of each hole, counter-clockwise [m]."""

    def cubics(self) -> Array | None:
        """(k, 4, 2) control points of a smooth boundary's pieces, None of a polygon [m]."""


class Chosen(Protocol):
    """What ``verify`` needs to know of a chosen grasp, whoever chose it."""

    @property
    def shape(self) -> Any:
        """The outline, a ``Shape``, or the mesh."""

    @property
    def objective(self) -> str:
        """Its word."""

    @property
    def grasp(self) -> Grasp:
        """The contacts."""

    @property
    def states(self) -> tuple[GraspState, ...]:
        """Forces for the loads."""

    @property
    def value(self) -> float:
        """Of the worst load."""

    @property
    def bound(self) -> float:
        """No placement is better."""

    @property
    def places(self) -> Array:
        """(k,) arc lengths of the contacts, or (k, 3) their points in a mesh's coordinates [m]."""

    @property
    def others(self) -> tuple[Any, ...]:
        """Grasps that were passed over, with their ``value``."""

    @property
    def certificate(self) -> Any:
        """The proof of the bound, a ``Proof`` or a ``SurfaceProof``."""

    @property
    def max_force(self) -> float | None:
        """Limit on every force [N]."""

    @property
    def min_normal(self) -> float:
        """With which every finger pushes at the least [N]."""

    @property
    def length(self) -> float | None:
        """By which torques are divided, of ``wrench_ball`` [m]."""

    @property
    def deviations(self) -> Array | None:
        """(m, 3) of ``answered`` [N, N m]."""
