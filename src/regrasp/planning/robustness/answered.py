"""How far each thing may be off while some forces exist: what no controller can exceed."""

from collections.abc import Callable, Iterable
from functools import partial
from math import inf, isnan, nan, pi

import numpy as np

from regrasp.closed_form.choice import EFFORT, best_squeeze
from regrasp.errors import Infeasible, SolverFailed
from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.orientation.tangents import tangents_of
from regrasp.mechanics.robust.moved import moved
from regrasp.mechanics.wrench import Wrench, torque
from regrasp.planning.robustness.views import View
from regrasp.planning.states.choosing import choose_forces
from regrasp.planning.states.criteria import ChosenState, Criteria
from regrasp.planning.states.solving import Chooser, force_unit
from regrasp.planning.states.two_fingers import is_one_point
from regrasp.planning.surveys.extremes.largest_load import largest_load
from regrasp.planning.surveys.extremes.load_reach import largest_share

SQUEEZE = 1e6
"""Forces are at most this multiple of the load where nothing else limits them."""
VIEWS = 12
"""States of a plan that are looked at, at most: fewer leave the answer an upper bound."""
_DIRECTIONS = 8
_SCAN, _HALVINGS = 12, 26


class Answered:
    """Fingers at work, with the limits that are judged, and the loads to hold: the load with each deviation.

    Of a disturbance that is round nothing is asked: only a hull has vertices.
    """

    def __init__(self, view: View, base: LoadSet | None) -> None:
        rest = view.at_work
        limits = rest.limits.tolist()
        share = rest.share
        self.grasp = Grasp(_limited(c, m, share) for c, m in zip(rest.grasp, limits, strict=True))
        self.load, self.names = view.state.load, rest.grasp.names
        corners = None if base is None else base.vertices
        self.deviations = [Wrench.from_vector(v) for v in ([] if corners is None else corners)]
        self.deviations = self.deviations or [0.0 * self.load]
        self.known: dict[int, Array] = {}  # forces that held a load not far from the next

    def friction(self) -> float:
        """The least factor on all coefficients."""
        found = 0.0
        for deviation in self.deviations:
            load = self.load + deviation
            if not load.vector.any():
                continue
            criteria = Criteria("friction_use", SQUEEZE * force_unit(self.grasp, load), reserve=0.0)
            try:
                state = ChosenState(self.grasp, load, criteria, choose_forces(self.grasp, load, criteria))
            except (Infeasible, SolverFailed):
                return nan
            found = max(found, 0.0 if np.isnan(state.value) else state.value)
        return found

    def load_factor(self) -> float:
        """The largest factor of the load."""
        if not self.load.vector.any():
            return inf
        return min(self._largest(self.load, deviation) for deviation in self.deviations)

    def centre(self) -> float:
        """How far the centre of mass may be off, across the load's force, in two or eight directions [m]."""
        force = self.load.force
        if not force.any():
            return inf
        across = tangents_of((force / np.linalg.norm(force))[None])[0]
        ways = _around(len(across)) @ across
        moments = [Wrench.from_vector(np.concatenate([0 * force, np.ravel(torque(a, force))])) for a in ways]
        return min(self._largest(m, self.load + deviation) for m in moments for deviation in self.deviations)

    def tilt(self) -> float:
        """How far the load's force may turn, its torque staying, in two or eight directions [rad]."""
        force = self.load.force
        size = float(np.linalg.norm(force))
        if size == 0:
            return pi
        axis = force / size
        across = tangents_of(axis[None])[0]

        def held(way: Array, a: float) -> bool:
            turned = size * (np.cos(a) * axis + np.sin(a) * way)
            return self._holds(self.grasp, Wrench.from_vector(np.concatenate([turned, self.load.torque])))

        ways = _around(len(across)) @ across
        return min(self._first(partial(held, way), pi) for way in ways)

    def position(self, i: int, curvatures: Array, reach: float) -> float:
        """How far contact ``i`` may be off along its tangents, in two or eight directions [m]."""
        offsets = np.zeros((len(self.grasp), self.grasp.dimension - 1))
        curvature = float(curvatures[i])
        most = reach if curvature == 0 else min(reach, 3.0 / abs(curvature))

        def held(way: Array, s: float) -> bool:
            off = offsets.copy()
            off[i] = s * way
            return self._holds(moved(self.grasp, off, curvatures), self.load)

        ways = _around(offsets.shape[1])
        found = min(self._first(partial(held, way), most) for way in ways)
        return inf if found >= most else found

    def _largest(self, direction: Wrench, base: Wrench) -> float:
        try:
            return largest_load(self.grasp, direction, base).factor
        except (Infeasible, SolverFailed):
            return nan

    def _holds(self, grasp: Grasp, load: Wrench) -> bool:
        return all(self._held(grasp, load + deviation, k) for k, deviation in enumerate(self.deviations))

    def _held(self, grasp: Grasp, load: Wrench, k: int) -> bool:
        """Whether forces exist: those last found, moved into equilibrium, or others by a program."""
        if not load.vector.any():
            return True
        mu, limits, rows = grasp.frictions.tolist(), grasp.max_forces.tolist(), grasp.limit_rows
        if len(grasp) == 2 and grasp.dimension == 2 and rows is None and not is_one_point(grasp):
            first, second = (contact.plain for contact in grasp)
            found = best_squeeze(*first, *second, *load.plain, EFFORT, *limits, 1.0)  # type: ignore[arg-type, call-arg]
            return not isnan(found[0])
        if k in self.known:
            moved = Chooser(grasp, load, "clarabel", None, limits).shifted(self.known[k], mu, limits)
            if moved is not None and (rows is None or rows.kept(moved)):
                return True
        state = largest_share(grasp, load, limits).state
        if state is not None:
            self.known[k] = grasp.cones.measured(state.forces)
        return state is not None

    def _first(self, holds: Callable[[float], bool], most: float) -> float:
        """Where it first does not hold, looked for in steps; ``most`` where it does everywhere."""
        low, high = 0.0, most
        for step in (most * (np.arange(_SCAN) + 1) / _SCAN).tolist():
            if not holds(step):
                high = step
                break
            low = step
        else:
            return most
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            low, high = (middle, high) if holds(middle) else (low, middle)
        return low


def some(views: Iterable[View]) -> list[View]:
    """Views of different fingers at work, evenly taken where there are many."""
    unlike: dict[object, View] = {}
    for view in views:
        unlike.setdefault((view.at_work.grasp, view.state.load), view)
    chosen = list(unlike.values())
    if len(chosen) <= VIEWS:
        return chosen
    return [chosen[k] for k in np.linspace(0, len(chosen) - 1, VIEWS).round().astype(int).tolist()]


def _limited(contact: Contact, limit: float, share: float) -> Contact:
    if contact.limits is not None and share < 1:
        contact = contact.changed(limits=contact.limits.scaled(share))
    return contact if limit == inf else contact.changed(max_force=limit)


def _around(size: int) -> Array:
    """(m, size) directions on a line or around a circle."""
    if size == 1:
        return np.array([[1.0], [-1.0]])
    angles = 2 * pi * np.arange(_DIRECTIONS) / _DIRECTIONS
    return np.column_stack([np.cos(angles), np.sin(angles)])
