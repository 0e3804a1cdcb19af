"""What a regrasp in space is to do: candidates on a mesh, directions of the load, plans on its holds."""

from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, pairwise
from math import atan2, pi, sin
from typing import TYPE_CHECKING

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, function, instance, rotation, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.reserve import RESERVE
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.holds.pairs import MOST_ORIENTATIONS
from regrasp.planning.holds.sequences import Sequence, preferred
from regrasp.planning.holds.spatial_stances import Quads
from regrasp.planning.holds.stances import Places
from regrasp.planning.holds.triples import FACETS, TripleFilter, TripleGraph, directions
from regrasp.planning.regrasps.ends import Ends
from regrasp.planning.regrasps.options import MOST_CANDIDATES, MOST_EXTRA, check_steps, settled
from regrasp.planning.regrasps.steps import (
    Chosen,
    chosen_state,
    eased_by,
    kept,
    least_margin,
    pieces_of,
    spread_states,
    step_between,
)
from regrasp.planning.states.criteria import PEAK_RATIO, Criteria
from regrasp.planning.states.objectives import FORCE, Objective
from regrasp.plans.regrasp_plan import RegraspPlan, accumulated
from regrasp.plans.timing import TimeScaling
from regrasp.plans.transition import Transition

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh

MAX_TURN = pi / 2
"""Default largest turn during one step in space [rad]: forces grow by 1 / cos(turn / 2) = 1.41 at most."""
# Directions nearer than this [rad] are one.
_SAME = 1e-9


@dataclass(frozen=True, eq=False)
class SpaceRegraspProblem(ArrayValue):
    """From one grasp of four fingers to another: what is asked, its triples that hold, and the plans.

    Args:
        mesh: a ``Mesh``; fingers may touch at ``candidates`` points spread over it, of ``friction``, and at
            the contacts of ``start`` and ``goal``, four each, relative to the centre of mass.
        start: four contacts, relative to the centre of mass [m].
        goal: four contacts at the end, relative to the centre of mass [m].
        load: a force through the centre of mass, fixed in the world, seen from the object before it turns
            [N].
        friction: Coulomb coefficient of the candidates [-].
        orientations: directions of the load, seen from the object, that are tried, spread over the sphere;
            the start's and the goal's are tried besides. 1 forbids turning.
        goal_rotation: (3, 3) from the object's frame in the end to its frame at the start; the same if not
            given.
        candidates: how many points are spread over the mesh.
        objective: what the state of every hold is chosen for.
        states: ``each``, or ``joint``: all states in one program, for the widest worst force margin and then
            the least change of force.
        max_turn: largest turn during one step [rad], below pi.
        least_margin: angle margin [rad] that every hold must have in its inner pyramids of ``facets`` faces.
        min_distance: least distance of two fingers that hold together [m].
        keep: which three fingers may hold together, by reach or collision: a function of points (k, 3) of
            each of them, relative to the centre of mass [m], that returns (k,) booleans; all if not given.
        facets: faces of the inner pyramids in which holds are judged.
        seed: of the candidates.
        max_force: limit on every force besides the contacts' own [N], as for ``choose_state``.
        peak_ratio: as for ``choose_state`` [-].
        reserve: as for ``choose_state`` [-].
        step_duration: [s] of each step.

    Raises:
        InvalidInput: For arguments that are not what they must be.
    """

    mesh: "Mesh"
    start: Grasp
    goal: Grasp
    load: Wrench
    friction: float
    orientations: int = 42
    goal_rotation: ArrayLike | None = None
    candidates: int = 40
    objective: str | Objective | Criteria = "angle"
    states: str = "each"
    max_turn: float = MAX_TURN
    least_margin: float = 0.0
    min_distance: float = 0.0
    keep: TripleFilter | None = None
    facets: int = FACETS
    seed: int = 0
    max_force: float | None = None
    peak_ratio: float = PEAK_RATIO
    reserve: float = RESERVE
    step_duration: float = 1.0

    def __post_init__(self) -> None:
        from regrasp.mesh.mesh import Mesh

        instance(self.mesh, "mesh", Mesh)
        _ = self.criteria, self.rotation
        load = self.load
        if not isinstance(load, Wrench) or load.dimension != 3 or load.torque.any() or not load.force.any():
            raise InvalidInput(f"load must be a force in space through the centre of mass, got {shown(load)}")
        check_steps(self.step_duration, self.states, self.max_turn, self.least_margin)
        whole(self.orientations, "orientations", least=0, most=MOST_ORIENTATIONS)
        whole(self.candidates, "candidates", least=1, most=MOST_CANDIDATES)
        whole(self.seed, "seed", least=0)
        if self.keep is not None:
            function(self.keep, "keep", "a function of first, second and third points", 3)
        _ = self.directions, self.graph

    @cached_property
    def criteria(self) -> Criteria:
        """Objective and limits of every choice of a state."""
        return settled(self)

    @cached_property
    def rotation(self) -> Array:
        """(3, 3) from the object's frame in the end to its frame at the start."""
        return np.eye(3) if self.goal_rotation is None else rotation(self.goal_rotation, "goal_rotation")

    @cached_property
    def ends(self) -> Ends:
        """The contacts of both grasps, which are on the mesh."""
        ends = Ends(self.start, self.goal, self.max_force, fingers=4, dimension=3)
        centre = self.mesh.centre_of_mass
        for contact in ends.contacts:
            on = self.mesh.nearest(contact.position + centre) - centre
            ends.refuse_off(contact, on, float(self.mesh.size.max()), "mesh")
        return ends

    @cached_property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts of both ends, then the candidates; with their whole friction."""
        sampled = self.mesh.contacts(
            self.candidates, friction=self.friction, max_force=self.max_force, seed=self.seed
        )
        return self.ends.joined(list(sampled))

    @cached_property
    def directions(self) -> Array:
        """(O, 3) unit directions of the load seen from the object: at the start, in the end, and others."""
        first = self.load.force / np.linalg.norm(self.load.force)
        last = self.rotation.T @ first
        turns = _angle(first, last) > _SAME
        if self.orientations <= 1:
            if self.orientations < 1:
                raise InvalidInput(f"orientations must be at least 1, got {self.orientations}")
            if turns:
                raise InvalidInput("orientations=1 forbids turning, but goal_rotation turns the load")
            return first[None]
        given = [first, last] if turns else [first]
        others = directions(self.orientations)[:, :3]
        away = [all(_angle(other, one) > _SAME for one in given) for other in others]
        return np.vstack([given, others[away]])

    @cached_property
    def graph(self) -> TripleGraph:
        """The triples that hold the load in these directions."""
        size = float(np.linalg.norm(self.load.force))
        loads = np.pad(size * self.directions, ((0, 0), (0, 3)))
        return TripleGraph(
            self.contacts, loads, self.facets, self.peak_ratio, self.reserve, self.min_distance, self.keep
        )

    @property
    def places(self) -> tuple[Places, Places, int]:
        """The start's and the goal's contacts in the graph, and the place of the last direction."""
        last = self.rotation.T @ self.directions[0]
        return self.ends.start, self.ends.goal, int(_angle(self.directions[0], last) > _SAME)

    def sequences(self, extra: int = 0) -> list[Sequence]:
        """The best sequence of holds, and those of up to ``extra`` more moves with wider margins.

        Args:
            extra: finger moves beyond the fewest.
        """
        whole(extra, "extra", least=0, most=MOST_EXTRA)
        stances = Quads(self.graph, self.directions, self.max_turn, self.least_margin)
        return preferred(stances, *self.places, extra)

    def plans(self, extra: int = 0) -> list[RegraspPlan]:
        """The plan of each sequence.

        Args:
            extra: finger moves beyond the fewest.

        Raises:
            Infeasible: Where there is none, and says why.
        """
        whole(extra, "extra", least=0, most=MOST_EXTRA)
        found = self.sequences(extra)
        if not found:
            raise self._why_not()
        try:
            return [self._plan(sequence) for sequence in found]
        except Infeasible:
            raise self._unheld_end() or self._why_not() from None

    def _plan(self, sequence: Sequence) -> RegraspPlan:
        whole = replace(self.criteria, objective=FORCE)
        start, goal, last = self.places
        nodes = [(start, 0), *((tuple(places), o) for *places, o in sequence.holds), (goal, last)]
        turns = [_angle(self.directions[a], self.directions[b]) for (_, a), (_, b) in pairwise(nodes)]
        pieces = [pieces_of(turn, self.max_turn) for turn in turns]
        sizes = [0.0, *(turn / n for turn, n in zip(turns, pieces, strict=True)), 0.0]
        states: list[Chosen] = []
        ways: list[Array] = []

        def add(places: Places, way: Array, criteria: Criteria, ease: float) -> None:
            load = self._seen(way)
            state = chosen_state(places, self.contacts, load, criteria, ease)
            if len(places) < len(start):
                if not state.all_work:
                    state = chosen_state(places, self.contacts, load, whole, ease)
                state = kept(state, self.contacts, self.criteria, ease, self.least_margin)
            states.append(state)
            ways.append(way)

        for k, (places, o) in enumerate(nodes):
            if k:  # where the object turns by more than a step may, the contacts of both hold in between
                before, a = nodes[k - 1]
                every = tuple(dict.fromkeys((*before, *places)))
                for q in range(1, pieces[k - 1]):
                    add(every, self._between(a, o, q / pieces[k - 1]), whole, eased_by(sizes[k]))
            criteria = self.criteria if len(places) < len(start) else whole
            add(places, self.directions[o], criteria, eased_by(max(sizes[k : k + 2])))
        if self.states == "joint":
            states = spread_states(states, self.criteria, self.least_margin)
        scaling = TimeScaling.spline(self.step_duration)
        steps = [
            step_between(a, b, self.contacts, scaling, self.criteria, *_turn(u, v))
            for (a, b), (u, v) in zip(pairwise(states), pairwise(ways), strict=True)
        ]
        steps += self._last_turn(steps, scaling)
        turned, rotations = accumulated(steps)
        return RegraspPlan(tuple(steps), turned, least_margin(states), rotations=rotations)

    def _seen(self, way: Array) -> Wrench:
        """The load seen in a direction; that of the start as it was given."""
        if way is self.directions[0] or (way == self.directions[0]).all():
            return self.load
        return Wrench(float(np.linalg.norm(self.load.force)) * way)

    def _between(self, a: int, b: int, share: float) -> Array:
        """The direction a share of the way from one to another, along their great circle."""
        u, v = self.directions[a], self.directions[b]
        whole = _angle(u, v)
        way: Array = sin((1 - share) * whole) * u + sin(share * whole) * v
        return way / np.linalg.norm(way)

    def _last_turn(self, steps: list[Transition], scaling: TimeScaling) -> list[Transition]:
        """A turn about the load, which changes no force, to where the object is to be; none if it is."""
        from regrasp.planning.changes.rotation import plan_rotation

        _, rotations = accumulated(steps)
        rest = rotations[-1].T @ self.rotation
        axis = steps[-1].end.load.force / np.linalg.norm(self.load.force)
        off = np.array([rest[2, 1] - rest[1, 2], rest[0, 2] - rest[2, 0], rest[1, 0] - rest[0, 1]])
        angle = atan2(float(off @ axis), float(np.trace(rest)) - 1)
        if abs(angle) <= _SAME:
            return []
        end = steps[-1].end
        return [plan_rotation(end, angle, axis=axis, end=end, scaling=scaling, reserve=self.reserve)]

    def _unheld_end(self) -> Infeasible | None:
        """The error of an end that even four fingers cannot hold."""
        start, goal, last = self.places
        for what, places, o in (("start", start, 0), ("goal", goal, last)):
            try:
                whole = replace(self.criteria, objective=FORCE)
                chosen_state(places, self.contacts, self._seen(self.directions[o]), whole)
            except Infeasible as reason:
                message = f"the fingers of the {what} cannot hold the load there: {reason}"
                return Infeasible(message, reason.certificate)
        return None

    def _held(self, graph: TripleGraph, places: Places) -> bool:
        """Whether any three of four fingers hold the load in any direction, with the least margin."""
        triples = [graph.triple(*three) for three in combinations(sorted(places), 3)]
        return bool((graph.margins[:, triples] >= max(self.least_margin, 0.0)).any())

    def _in_the_way(self, places: Places) -> str | None:
        """In words, an option without which three fingers of an end would hold; None where there is none."""
        four = tuple(self.contacts[place] for place in places)
        load = self.graph.loads
        free = tuple(c.changed(max_force=None) for c in four)
        variants = {
            "keep": (four, self.min_distance, None),
            f"min_distance={self.min_distance:g}": (four, 0.0, self.keep),
            "these force limits": (free, self.min_distance, self.keep),
        }
        for option, (contacts, apart, keep) in variants.items():
            graph = TripleGraph(contacts, load, self.facets, self.peak_ratio, self.reserve, apart, keep)
            if self._held(graph, tuple(range(4))):
                return option
        return None

    def _why_not(self) -> Infeasible:
        """Which end has no hold, or how far the fingers come from both."""
        unheld = self._unheld_end()
        if unheld is not None:
            return unheld
        start, goal, _ = self.places
        count = len(self.directions)
        where = (
            f"in any of {count} directions, to which all four may turn the object," if count > 1 else "there"
        )
        for what, places in (("start", start), ("goal", goal)):
            if not self._held(self.graph, places):
                option = self._in_the_way(places)
                if option is not None:
                    return Infeasible(
                        f"no three fingers of the {what} hold the load {where} with {option}; without it "
                        f"they do"
                    )
                wanted = f" with a margin of {self.least_margin:.4g} rad" if self.least_margin else ""
                return Infeasible(
                    f"no three fingers of the {what} hold the load {where}{wanted} (in inner pyramids of "
                    f"{self.graph.facets} facets), so none of its fingers can leave or arrive; more "
                    f"friction, other contacts or more facets may do"
                )
        holding = int((self.graph.margins >= 0).any(axis=0).sum())
        return Infeasible(
            f"no sequence of holds leads from the start to the goal on {len(self.contacts)} points and "
            f"{len(self.directions)} directions of the load, of which {holding} triples hold one; try more "
            f"candidates, orientations, facets or friction, a larger max_turn, or a smaller least_margin"
        )


def _turn(u: Array, v: Array) -> tuple[float, Array | None]:
    """The turn of the object that takes the load from one direction to another, and its axis."""
    if (u == v).all():
        return 0.0, None
    across = np.cross(v, u)
    return _angle(u, v), across / np.linalg.norm(across)


def _angle(a: Array, b: Array) -> float:
    """Between two unit vectors [rad], to rounding."""
    return atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))
