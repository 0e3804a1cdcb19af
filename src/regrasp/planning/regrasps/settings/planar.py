"""Regrasps of planar objects: an outline, angles of the object, pairs of contacts that hold."""

from collections.abc import Iterable, Sequence
from functools import cached_property
from itertools import pairwise
from math import degrees, pi

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, number
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.loads.rotated import turned_load
from regrasp.mechanics.reserve import kept_friction
from regrasp.mechanics.wrench import Wrench
from regrasp.outline import Outline
from regrasp.planning.holds.graphs import AnyGraph
from regrasp.planning.holds.pairs import HoldGraph, evenly
from regrasp.planning.holds.planar_stances import HALF_TURN, Fingering
from regrasp.planning.regrasps.asked import Asked, without_limits
from regrasp.planning.regrasps.settings.arcs import arc_lengths, on_arcs
from regrasp.planning.regrasps.steps import Chosen, least_margin, step_between
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.timing import TimeScaling

SAMPLED = 72
"""Orientations that are tried where all of them are not looked at in closed form."""
CANDIDATES = 120
"""Default points on an outline."""
# A goal nearer than this to one of the orientations is that one [rad].
_SAME_ANGLE = 1e-9


class PlanarSetting:
    """The plane, as ``Setting`` says."""

    reach = HALF_TURN
    fingers, shape, grasp = 3, "outline", "three planar contacts"

    def __init__(self, problem: Asked) -> None:
        assert isinstance(problem.outline, Outline)
        self._problem, self._outline = problem, problem.outline
        number(problem.goal_orientation, "goal_orientation")
        for name, default in (("goal_rotation", None), ("seed", 0), ("facets", None)):
            if getattr(problem, name) is not default:
                raise InvalidInput(f"{name} is of regrasps on a mesh; leave it out on an outline")
        self.size = self._outline.length

    @cached_property
    def orientations(self) -> Sequence[float]:
        """(O,) angles of the object that are tried [rad], the goal's among them."""
        problem = self._problem
        spread = evenly(SAMPLED if problem.orientations is None else problem.orientations)
        off = abs((spread - problem.goal_orientation + pi) % (2 * pi) - pi)
        if off.min() <= _SAME_ANGLE:
            return list(spread.tolist())
        if problem.orientations == 1:
            raise InvalidInput(
                f"orientations=1 forbids turning, but goal_orientation is {problem.goal_orientation:g} rad"
            )
        return [*spread.tolist(), problem.goal_orientation % (2 * pi)]

    @property
    def last(self) -> int:
        """The place of the angle in the end."""
        off = (np.array(self.orientations) - self._problem.goal_orientation + pi) % (2 * pi) - pi
        return int(np.argmin(abs(off)))

    def nearest(self, position: Array) -> Array:
        """The point of the outline nearest to one, both relative to the centre of mass [m]."""
        centre = self._outline.centre_of_mass
        return self._outline.points(self._outline.nearest(position + centre))

    def sampled(self) -> list[Contact]:
        """Points spread over the outline, or those asked for."""
        problem = self._problem
        asked = CANDIDATES if problem.candidates is None else problem.candidates
        places = self._outline.sample(asked) if isinstance(asked, int) else np.unique(np.asarray(asked))
        return [
            self._outline.contact_at(float(s), friction=problem.friction, max_force=problem.max_force)
            for s in places
        ]

    def reachable(self, contacts: Sequence[Contact]) -> NDArray[np.bool_]:
        """(3, V) which finger may touch which contact."""
        assert self._problem.arcs is not None
        places = arc_lengths(self._outline, np.array([c.position for c in contacts]))
        return on_arcs(self._problem.arcs, places, self._outline.length)

    def graph_on(self, contacts: Iterable[Contact]) -> HoldGraph:
        """The holds of contacts, with the friction that the reserve leaves."""
        problem = self._problem
        usable = without_limits(contacts)
        kept = tuple(c.changed(friction=kept_friction(c.friction, problem.reserve)) for c in usable)
        return HoldGraph(
            kept, problem.load, np.array(self.orientations), problem.peak_ratio, problem.min_distance,
            problem.keep, one_finger=problem.one_finger, min_normal=problem.min_normal or 0.0,
        )  # fmt: skip

    def stances(
        self,
        graph: AnyGraph,
        max_turn: float,
        reach: float,
        allowed: NDArray[np.bool_] | None,
        least: float,
    ) -> Fingering:
        """Where three fingers stand."""
        assert isinstance(graph, HoldGraph)
        return Fingering(graph, max_turn, least, allowed, reach)

    def seen(self, orientation: float) -> Wrench:
        """The load, seen from the object at an angle."""
        return turned_load(self._problem.load, orientation)

    def where(self, orientation: float) -> str:
        """In words."""
        return f"at {degrees(orientation):.4g} deg"

    def along(self, orientations: Sequence[float]) -> list[float]:
        """The same angles, each at most half a turn from the one before it, the first from 0."""
        result: list[float] = []
        for angle in (0.0, *orientations, self._problem.goal_orientation):
            last = result[-1] if result else 0.0
            result.append(angle + 2 * pi * round((last - angle) / (2 * pi)))
        return result

    def turn(self, before: float, after: float) -> float:
        """How far the object turns [rad]."""
        return abs(after - before)

    def between(self, before: float, after: float, share: float) -> float:
        """The angle a share of the way from one to another."""
        return before + share * (after - before)

    def plan(
        self, states: Sequence[Chosen], orientations: Sequence[float], scaling: TimeScaling
    ) -> RegraspPlan:
        """The steps between states that follow one another."""
        problem = self._problem
        steps = [
            step_between(a, b, problem.contacts, scaling, problem.criteria, y - x)
            for (a, b), (x, y) in zip(pairwise(states), pairwise(orientations), strict=True)
        ]
        return RegraspPlan(tuple(steps), tuple(orientations), least_margin(states))
