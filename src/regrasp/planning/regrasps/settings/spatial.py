"""Regrasps in space: a mesh, directions in which the object sees the load, triples of contacts that hold."""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import atan2, pi, sin
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, function, number, rotation, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.holds.graphs import AnyGraph
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.stances import REACH
from regrasp.planning.holds.triples import FACETS, TripleGraph, directions
from regrasp.planning.regrasps.asked import Asked, without_limits
from regrasp.planning.regrasps.settings.regions import on_regions
from regrasp.planning.regrasps.steps import Chosen, least_margin, step_between
from regrasp.planning.states.criteria import Criteria
from regrasp.planning.states.objectives import ANGLE
from regrasp.plans.regrasp_plan import RegraspPlan, accumulated
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh

MAX_TURN = pi / 2
"""Default largest turn during one step in space [rad]: forces grow by 1 / cos(turn / 2) = 1.41 at most."""
SAMPLED, CANDIDATES = 42, 40
"""Default directions of the load that are tried, and points on the mesh."""
# Directions nearer than this [rad] are one.
_SAME = 1e-9


class SpatialSetting:
    """Space, as ``Setting`` says."""

    reach = REACH
    fingers, shape, grasp = 4, "mesh", "four contacts in space"

    def __init__(self, problem: Asked, mesh: "Mesh") -> None:
        self._problem, self._mesh = problem, mesh
        if number(problem.goal_orientation, "goal_orientation"):
            raise InvalidInput("goal_orientation is an angle in the plane; on a mesh give goal_rotation")
        if problem.one_finger:
            raise InvalidInput("one_finger is of pairs of fingers on an outline; leave it out on a mesh")
        load = problem.load
        if not isinstance(load, Wrench) or load.dimension != 3 or load.torque.any() or not load.force.any():
            raise InvalidInput(f"load must be a force in space through the centre of mass, got {shown(load)}")
        whole(problem.seed, "seed", least=0)
        if problem.keep is not None:
            function(problem.keep, "keep", "a function of first, second and third points", 3)
        self.size = float(mesh.size.max())
        self.rotation = (
            np.eye(3) if problem.goal_rotation is None else rotation(problem.goal_rotation, "goal_rotation")
        )

    @cached_property
    def orientations(self) -> Array:
        """(O, 3) unit directions of the load seen from the object: at the start, in the end, and others."""
        count = SAMPLED if self._problem.orientations is None else self._problem.orientations
        first = self._problem.load.force / np.linalg.norm(self._problem.load.force)
        last = self.rotation.T @ first
        turns = _angle(first, last) > _SAME
        if count == 1:
            if turns:
                raise InvalidInput("orientations=1 forbids turning, but goal_rotation turns the load")
            return np.array(first[None])
        given = [first, last] if turns else [first]
        others = directions(count)[:, :3]
        away = [all(_angle(other, one) > _SAME for one in given) for other in others]
        return np.vstack([given, others[away]])

    @property
    def last(self) -> int:
        """The place of the direction in the end."""
        return int(_angle(self.orientations[0], self.rotation.T @ self.orientations[0]) > _SAME)

    def nearest(self, position: Array) -> Array:
        """The point of the mesh nearest to one, both relative to the centre of mass [m]."""
        centre = self._mesh.centre_of_mass
        return np.asarray(self._mesh.nearest(position + centre) - centre)

    def sampled(self) -> list[Contact]:
        """Points spread over the mesh, or those asked for."""
        problem = self._problem
        count = CANDIDATES if problem.candidates is None else problem.candidates
        if not isinstance(count, int):
            places = np.unique(np.asarray(count), axis=0) + self._mesh.centre_of_mass
            mu, most = problem.friction, problem.max_force
            try:
                return [self._mesh.contact_at(point, friction=mu, max_force=most) for point in places]
            except InvalidInput as error:
                raise InvalidInput(
                    f"candidates are relative to the centre of mass, such as mesh.sample(30) - "
                    f"mesh.centre_of_mass: {error}"
                ) from None
        return list(
            self._mesh.contacts(
                count, friction=problem.friction, max_force=problem.max_force, seed=problem.seed
            )
        )

    def reachable(self, contacts: Sequence[Contact]) -> NDArray[np.bool_]:
        """(4, V) which finger may touch which contact."""
        assert self._problem.arcs is not None
        return on_regions(self._problem.arcs, np.array([c.position for c in contacts]))

    def graph_on(self, contacts: Iterable[Contact]) -> TripleGraph:
        """The triples that hold the load in these directions."""
        problem = self._problem
        size = float(np.linalg.norm(problem.load.force))
        loads = np.pad(size * self.orientations, ((0, 0), (0, 3)))
        facets = FACETS if problem.facets is None else problem.facets
        return TripleGraph(
            without_limits(contacts), loads, facets, problem.peak_ratio, problem.reserve,
            problem.min_distance, problem.keep,
        )  # fmt: skip

    def stances(
        self,
        graph: AnyGraph,
        max_turn: float,
        reach: float,
        allowed: NDArray[np.bool_] | None,
        least: float,
    ) -> Quads:
        """Where four fingers stand."""
        assert isinstance(graph, TripleGraph)
        return Quads(graph, self.orientations, max_turn, least, reach, allowed)

    def seen(self, orientation: Array) -> Wrench:
        """The load seen in a direction; that of the start as it was given."""
        if (orientation == self.orientations[0]).all():
            return self._problem.load
        return Wrench(float(np.linalg.norm(self._problem.load.force)) * orientation)

    def where(self, orientation: Array) -> str:
        """In words."""
        return "there"

    def along(self, orientations: Sequence[Array]) -> list[Array]:
        """Directions from that at the start to that in the end."""
        return [self.orientations[0], *orientations, self.orientations[self.last]]

    def turn(self, before: Array, after: Array) -> float:
        """How far the object turns [rad]."""
        return _angle(before, after)

    def between(self, before: Array, after: Array, share: float) -> Array:
        """The direction a share of the way from one to another, along their great circle."""
        turn = _angle(before, after)
        if turn <= _SAME:
            return before
        way: Array = sin((1 - share) * turn) * before + sin(share * turn) * after
        return way / np.linalg.norm(way)

    def plan(
        self, states: Sequence[Chosen], orientations: Sequence[Array], scaling: TimeScaling
    ) -> RegraspPlan:
        """The steps between states that follow one another, and a turn about the load."""
        problem = self._problem
        steps = [
            step_between(a, b, problem.contacts, scaling, problem.criteria, *_turn(u, v))
            for (a, b), (u, v) in zip(pairwise(states), pairwise(orientations), strict=True)
        ]
        steps += self._last_turn(steps, scaling, states[-1].criteria)
        turned, rotations = accumulated(steps)
        return RegraspPlan(tuple(steps), turned, least_margin(states), rotations=rotations)

    def _last_turn(
        self, steps: list[Transition], scaling: TimeScaling, criteria: Criteria
    ) -> list[Transition]:
        """A turn about the load, which changes no force, to where the object is to be; none if it is."""
        from regrasp.planning.changes.rotation import plan_rotation

        _, rotations = accumulated(steps)
        rest = rotations[-1].T @ self.rotation
        axis = steps[-1].end.load.force / np.linalg.norm(self._problem.load.force)
        off = np.array([rest[2, 1] - rest[1, 2], rest[0, 2] - rest[2, 0], rest[1, 0] - rest[0, 1]])
        angle = atan2(float(off @ axis), float(np.trace(rest)) - 1)
        if abs(angle) <= _SAME:
            return []
        end, asked = steps[-1].end, replace(criteria, objective=ANGLE, max_force=None, controlled=())
        return [plan_rotation(end, angle, axis=axis, end=end, scaling=scaling, objective=asked)]


def _turn(u: Array, v: Array) -> tuple[float, Array | None]:
    """The turn of the object that takes the load from one direction to another, and its axis."""
    if (u == v).all():
        return 0.0, None
    across = np.cross(v, u)
    return _angle(u, v), across / np.linalg.norm(across)


def _angle(a: Array, b: Array) -> float:
    """Between two unit vectors [rad], to rounding."""
    return atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
