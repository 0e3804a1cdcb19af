"""The region in which the centre of mass may lie so that contacts hold the weight.

A weight W at c, relative to the present centre of mass, is the load (W, c x W): c along W does not matter.
In the plane what is left is one number, in space two, across W. The region is convex: its points come from
loads that are balanced, its sides from twists that prove the rest is not (Bretl and Lall, IEEE Trans.
Robotics 24, 2008).
"""

from dataclasses import dataclass, field
from math import hypot, inf

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, number, point, read_only
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.mechanics.state import GraspState, check_load
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench, torque
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.escape import infeasible
from regrasp.planning.surveys.extremes import convex_regions as regions
from regrasp.planning.surveys.extremes.load_reach import farthest, half_plane, held_state

GAP = 1e-3
REACH = 100.0
"""The region is sought within this many sizes of the grasp, where nothing bounds it."""
_SIDES = 200
_NOTHING = 1e-8  # of a region: rounding
_STALLED = 6  # asks that add nothing to what is known


@dataclass(frozen=True, eq=False, repr=False)
class HeldCentres(ArrayValue):
    """Where the centre of mass may lie, relative to the present one, under one weight.

    The weight's direction adds nothing: each point stands for the line through it along the weight.

    Args:
        grasp: the contacts that hold.
        weight: the external wrench that was asked for, object frame [N, N m].
        axes: (d - 1, d) unit vectors across the weight.
        inner: (m, d) vertices of a region that is held: their hull is that of the loads that ``states``
            balance.
        outer: (k, d) vertices of one that holds every centre that can be held: what lies beyond is proven not
            to be. In the plane both are the two ends of an interval and equal but for rounding.
        is_bounded: False where the region reaches as far as it was sought.
        states: a state for each point that is held.
    """

    grasp: Grasp
    weight: Wrench
    axes: Array
    inner: Array
    outer: Array
    is_bounded: bool
    states: tuple[GraspState, ...] = field(compare=False)

    @property
    def vertices(self) -> Array:
        """(m, d) of the region that is proven held."""
        return self.inner

    @property
    def size(self) -> float:
        """Length of the interval [m], or area of the polygon [m^2], that is held."""
        return regions.size(self.inner @ self.axes.T)

    @property
    def gap(self) -> float:
        """What is undecided, relative to what may be held; 0 of a region that is a point but for rounding."""
        largest = regions.size(self.outer @ self.axes.T)
        point = (_NOTHING * (self.grasp.size or 1.0)) ** len(self.axes)
        return (largest - self.size) / largest if largest > point else 0.0

    def contains(self, centre: ArrayLike) -> bool | None:
        """Whether a centre of mass (d,) is held; None where that is not decided, between inner and outer.

        Args:
            centre: (d,) relative to the present centre of mass, object frame [m].
        """
        at = self.axes @ point(centre, "centre")
        if regions.contains(self.inner @ self.axes.T, at):
            return True
        return None if regions.contains(self.outer @ self.axes.T, at) else False

    def __str__(self) -> str:
        what, unit = ("length", "m") if self.grasp.dimension == 2 else ("area", "m^2")
        edge = "" if self.is_bounded else ", as far as was sought"
        return (
            f"{', '.join(self.grasp.names)} hold {self.weight!r} with centres of mass over a region of "
            f"{what} {self.size:.6g} {unit}{edge}, {100 * max(self.gap, _NOTHING):.2g} % undecided or less"
        )

    def __repr__(self) -> str:
        return f"HeldCentres({self})"


def held_centres(
    grasp: Grasp,
    weight: Wrench,
    *,
    max_force: float | None = None,
    gap: float = GAP,
    reach: float = REACH,
) -> HeldCentres:
    """The centres of mass, relative to the present one, at which contacts hold a weight.

    Args:
        grasp: the contacts that hold.
        weight: a force through the centre of mass; a torque besides stays where it is. The contacts stay,
            too.
        max_force: limits every force besides the contacts' own limits [N].
        gap: in space, the undecided share of the area at which the search may stop.
        reach: how far from the present centre it goes, in sizes of the grasp.

    Raises:
        Infeasible: Where no centre within reach is held.
        InvalidInput: For bad input.
    """
    check_load(grasp, weight)
    if not weight.force.any():
        raise InvalidInput("weight must have a force: a torque alone does not depend on the centre of mass")
    number(gap, "gap", above=0)
    most, size = number(reach, "reach", above=0), grasp.size or 1.0
    unit = hypot(*weight.force)  # of a force whose squares vanish, too
    axes = tangents_of((weight.force / unit)[None])[0]
    limits = [f / unit for f in Criteria("effort", max_force, reserve=0.0).limits(grasp)]
    base = weight.vector / unit
    directions = np.zeros((base.size, len(axes)))
    # places in sizes of the grasp: whatever the unit of length, the numbers are near 1
    directions[grasp.dimension :] = size * np.array([torque(a, weight.force / unit) for a in axes]).T
    region = _Region(grasp, base, directions, limits, unit, most)
    region.search(gap)
    if not region.points:
        raise infeasible(grasp, weight, Criteria("effort", max_force, reserve=0.0))
    inner, outer = region.inner, region.outer
    bounded = bool(np.abs(outer).max() < most * (1 - 1e-9))
    inner, outer = read_only(size * inner @ axes), read_only(size * outer @ axes)
    return HeldCentres(grasp, weight, read_only(axes.copy()), inner, outer, bounded, tuple(region.states))


class _Region:
    """Points that are held and half-planes that hold all of them, in the coordinates across the weight."""

    def __init__(
        self, grasp: Grasp, base: Array, directions: Array, limits: list[float], unit: float, most: float
    ) -> None:
        self.grasp, self.base, self.directions = grasp, base, directions
        self.limits, self.unit, self.most = limits, unit, most
        self.points: list[Array] = []
        self.states: list[GraspState] = []
        self.asked: list[Array] = []
        p = directions.shape[1]
        self.outer = most * (
            np.array([[-1.0], [1.0]])
            if p == 1
            else np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]], dtype=float)
        )

    @property
    def inner(self) -> Array:
        """(m, p) the hull of the points."""
        return regions.hull(np.array(self.points))

    def search(self, gap: float) -> None:
        """Ask along the outer corner that is farthest from the inner region, until little is left between."""
        p = self.directions.shape[1]
        for direction in np.vstack([np.eye(p), -np.eye(p)]):
            self.ask(direction)
        if p == 1 or not self.points:
            return
        least, stalled = inf, 0
        for _ in range(_SIDES):
            inner, outer = self.inner, self.outer
            total = regions.size(outer)
            undecided = total - regions.size(inner)
            stalled = 0 if undecided < least * (1 - 1e-6) else stalled + 1
            least = min(least, undecided)
            if undecided <= gap * total or stalled > _STALLED:
                return
            direction = regions.widest_gap(inner, outer, self.asked)
            if direction is None:
                return
            self.ask(direction)

    def ask(self, direction: Array) -> None:
        """The farthest point along a direction, and the half-plane its dual proves."""
        self.asked.append(direction)
        found = farthest(self.grasp, self.base, self.directions, direction, self.limits, self.most, self.unit)
        if found.k is not None:
            inside = np.mean(self.points, axis=0) if self.points else np.zeros(len(direction))
            held = held_state(self.grasp, self.base, self.directions, found, inside, self.limits, self.unit)
            if held is not None:
                self.points.append(held[0])
                self.states.append(held[1])
        normal, bound = half_plane(
            self.grasp, self.base, self.directions, found.twist, self.limits, found.row_duals, self.unit
        )
        if bound < inf:
            self.outer = regions.clipped(self.outer, normal, bound)
