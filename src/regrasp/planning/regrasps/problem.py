"""What a regrasp is to do and under which limits: the hold graph, its ends, and the plans on it."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import ArrayLike, instance, number, whole
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.limits.force_limits import ForceLimits
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.reserve import RESERVE
from regrasp.mechanics.value import ArrayValue
from regrasp.mechanics.wrench import Wrench
from regrasp.outline import Outline
from regrasp.planning.changes.given_ends import refuse_set_without_none
from regrasp.planning.holds.bottleneck import Bottleneck, bottleneck
from regrasp.planning.holds.graphs import AnyGraph
from regrasp.planning.holds.pairs import MOST_ORIENTATIONS, Filter, HoldGraph
from regrasp.planning.holds.sequences import MAX_TURN, Sequence
from regrasp.planning.holds.stances import Places
from regrasp.planning.holds.triples import TripleFilter
from regrasp.planning.holds.turning.search import TurningSequence
from regrasp.planning.holds.weights import RegraspWeights
from regrasp.planning.regrasps.ends import Ends
from regrasp.planning.regrasps.kept_holds import kept_pairs
from regrasp.planning.regrasps.options import (
    MOST_EXTRA,
    check_steps,
    checked_candidates,
    settled,
    turn_below_pi,
)
from regrasp.planning.regrasps.planned import planned
from regrasp.planning.regrasps.remedies import allowed
from regrasp.planning.regrasps.sampled import sampled_sequences
from regrasp.planning.regrasps.settings.arcs import Arcs
from regrasp.planning.regrasps.settings.planar import PlanarSetting
from regrasp.planning.regrasps.settings.regions import Regions
from regrasp.planning.regrasps.settings.setting import Setting
from regrasp.planning.regrasps.settings.spatial import MAX_TURN as MAX_TURN_IN_SPACE
from regrasp.planning.regrasps.settings.spatial import SpatialSetting
from regrasp.planning.regrasps.turning import turning_sequences
from regrasp.planning.states.criteria import PEAK_RATIO, Criteria
from regrasp.planning.states.objectives import Objective
from regrasp.plans.regrasp_plan import RegraspPlan

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh


@dataclass(frozen=True, eq=False)
class RegraspProblem(ArrayValue):
    """From one grasp to another, of three fingers or four in space: what is asked, its holds, and the plans.

    Args:
        outline: an ``Outline``, or a ``Mesh`` in space; fingers may touch at ``candidates`` points spread
            over it, of ``friction``, and at the contacts of ``start`` and ``goal``.
        start: three contacts, in space four, relative to the centre of mass [m].
        goal: as many at the end, relative to the centre of mass [m].
        load: a force through the centre of mass, fixed in the world, seen from the object before it turns
            [N].
        friction: Coulomb coefficient of the candidates [-].
        orientations: how many angles of the object are tried, spread over a full turn, in space how many
            directions of the load seen from it; 1 to forbid turning. If not given all angles, in closed form;
            with ``keep`` or ``weights``, and in hold maps, bottlenecks and remedies, 72; in space 42.
        goal_orientation: the object's angle in the end [rad], in the plane; tried besides if it is none of
            these.
        candidates: how many points are spread over the shape, 120 if not given, in space 40; or where they
            are: arc lengths (k,) on an outline, such as those of ``OutlineRegrasps.walk``, in space points
            (k, 3) on the mesh, relative to the centre of mass [m].
        objective: what the state of every hold is chosen for, each by itself.
        states: ``each``, or ``joint``: all states in one program, for the widest worst force margin and then
            the least change of force.
        max_turn: largest turn during one step [rad], below pi; 2 pi / 3 if not given, in space pi / 2.
        least_margin: angle margin [rad] that every hold must have at the least, in space in its inner
            pyramids; more moves may be needed for it.
        min_distance: least distance of two fingers that hold together [m].
        keep: which fingers may hold together, by reach or collision: a function of points (k, 2) of the one
            and (k, 2) of the other, relative to the centre of mass [m], and the object's angle [rad], in
            space of the points (k, 3) of three, that returns (k,) booleans; all if not given.
        arcs: where each finger of the start may touch: an arc (lo, hi) in arc length [m], several, or None
            for everywhere (see ``arcs``); in space the corners (2, 3) of a box, a function of points (k, 3)
            that returns (k,) booleans, both relative to the centre of mass [m], or None. Any finger whose
            arc allows it may take a contact of the goal.
        one_finger: in the plane, whether a pair also holds where one of its fingers carries the whole load;
            by default both must push.
        limits: linear limits of every contact that has none of its own, in its frame (``ForceLimits``).
        disturbance: load deviations that every state and every step withstands, in the object's frame, zero
            among them where the object may turn; holds are then exchanged through a state of the fingers of
            both.
        stiffness: of the fingers that answer [N/m]: a number, or an array with a row for each finger of
            ``start``, as in ``Criteria``; all alike if not given.
        early_loss: whether forces, and the disturbance if any, are withstood, too, when a finger that leaves
            or arrives loses contact early.
        weights: look for the least cost in place of the fewest moves and the widest margin.
        max_force: limit on every force besides the contacts' own [N], as for ``choose_state``.
        peak_ratio: as for ``choose_state`` [-].
        reserve: as for ``choose_state`` [-].
        step_duration: [s] of each step.
        min_normal: with which every finger of a state pushes at the least, those that leave and arrive during
            a step apart [N]; 0 for none. If not given, and no ``Criteria`` are, 1 % of the load's force, or
            none where that takes more moves or leaves no sequence.
        goal_rotation: (3, 3) from the object's frame in the end to its frame at the start, in space; the same
            if not given.
        facets: faces of the inner pyramids in which holds in space are judged; 8 if not given.
        seed: of the candidates on a mesh.

    Raises:
        InvalidInput: For arguments that are not what they must be.
    """

    outline: "Outline | Mesh"
    start: Grasp
    goal: Grasp
    load: Wrench
    friction: float
    orientations: int | None = None
    goal_orientation: float = 0.0
    candidates: int | ArrayLike | None = None
    objective: str | Objective | Criteria = "angle"
    states: str = "each"
    max_turn: float | None = None
    least_margin: float = 0.0
    min_distance: float = 0.0
    keep: Filter | TripleFilter | None = None
    arcs: Arcs | Regions | None = None
    one_finger: bool = False
    limits: ForceLimits | None = None
    disturbance: LoadSet | None = None
    stiffness: ArrayLike | None = None
    early_loss: bool = False
    weights: RegraspWeights | None = None
    max_force: float | None = None
    peak_ratio: float = PEAK_RATIO
    reserve: float = RESERVE
    step_duration: float = 1.0
    min_normal: float | None = None
    goal_rotation: ArrayLike | None = None
    facets: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        from regrasp.mesh.mesh import Mesh

        if not isinstance(self.outline, (Outline, Mesh)):
            raise InvalidInput(f"a regrasp needs an Outline or a Mesh, got {shown(self.outline)}")
        _ = self.criteria
        if self.max_turn is None:
            most = MAX_TURN if isinstance(self.outline, Outline) else MAX_TURN_IN_SPACE
            object.__setattr__(self, "max_turn", most)
        check_steps(self.step_duration, self.states, self.largest_turn, self.least_margin)
        if self.orientations is not None:
            whole(self.orientations, "orientations", least=1, most=MOST_ORIENTATIONS)
        if self.candidates is not None:
            dimension = 2 if isinstance(self.outline, Outline) else 3
            object.__setattr__(self, "candidates", checked_candidates(self.candidates, dimension))
        number(self.min_distance, "min_distance", least=0)
        if not isinstance(self.one_finger, bool):
            raise InvalidInput(f"one_finger must be True or False, got {shown(self.one_finger)}")
        if self.limits is not None:
            instance(self.limits, "limits", ForceLimits)
        _ = self.ends
        if self.orientations != 1:
            refuse_set_without_none(self.criteria, self.start)
        if self.weights is not None and not isinstance(self.weights, RegraspWeights):
            raise InvalidInput(f"weights must be RegraspWeights, got {shown(self.weights)}")
        _ = self.setting.orientations, self.graph, self.allowed

    @cached_property
    def criteria(self) -> Criteria:
        """Objective and limits of every choice of a state."""
        return settled(self)

    @cached_property
    def setting(self) -> Setting:
        """What differs between the plane and space."""
        return (
            PlanarSetting(self) if isinstance(self.outline, Outline) else SpatialSetting(self, self.outline)
        )

    @cached_property
    def judges_holds(self) -> bool:
        """Whether margins of the graph are bounds, for it knows no linear limits, nor what is withstood."""
        return self.criteria.withstands or any(c.limits is not None for c in self.contacts)

    @cached_property
    def kept_pairs(self) -> NDArray[np.bool_]:
        """(P, O) whether pairs of the plane may keep linear limits and withstand what is asked."""
        assert isinstance(self.graph, HoldGraph)
        return kept_pairs(self, self.graph)

    @property
    def largest_turn(self) -> float:
        """Of one step [rad]."""
        assert self.max_turn is not None
        return self.max_turn

    @cached_property
    def ends(self) -> Ends:
        """The contacts of both grasps, which are on the shape."""
        setting = self.setting
        ends = Ends(self.start, self.goal, self.max_force, fingers=setting.fingers, wanted=setting.grasp)
        for contact in ends.contacts:
            ends.refuse_off(contact, setting.nearest(contact.position), setting.size, setting.shape)
        return ends

    @cached_property
    def contacts(self) -> tuple[Contact, ...]:
        """The contacts of both ends, then the candidates; with their whole friction."""
        contacts = self.ends.joined(self.setting.sampled())
        if self.limits is None:
            return contacts
        return tuple(c if c.limits is not None else c.changed(limits=self.limits) for c in contacts)

    @cached_property
    def graph(self) -> AnyGraph:
        """The holds of these contacts: a ``HoldGraph``, in space a ``TripleGraph``."""
        return self.graph_on(self.contacts)

    def graph_on(self, contacts: Iterable[Contact]) -> AnyGraph:
        """The holds of contacts.

        Args:
            contacts: relative to the centre of mass [m].
        """
        return self.setting.graph_on(contacts)

    @cached_property
    def allowed(self) -> NDArray[np.bool_] | None:
        """(fingers, V) which finger may touch which contact; None where all may touch all."""
        if self.arcs is None:
            return None
        allowed = self.setting.reachable(self.contacts)
        self.ends.check(allowed, self.arcs)
        return allowed

    @property
    def places(self) -> tuple[Places, Places, int]:
        """The start's and the goal's contacts in the graph, and the place of the last orientation."""
        return self.ends.start, self.ends.goal, self.setting.last

    def sequences(self, extra: int = 0, max_turn: float | None = None) -> list[Sequence]:
        """The best sequence among sampled orientations, and those of more moves with wider margins.

        Args:
            extra: finger moves beyond the fewest.
            max_turn: in place of the problem's [rad].
        """
        whole(extra, "extra", least=0, most=MOST_EXTRA)
        turn = self.largest_turn if max_turn is None else turn_below_pi(max_turn)
        return sampled_sequences(self, extra, turn, self.setting.reach)

    @property
    def is_exact(self) -> bool:
        """Whether all orientations are looked at, and not some of them."""
        planar = isinstance(self.outline, Outline)
        return planar and self.orientations is None and self.keep is None and self.weights is None

    def turning_sequences(self, extra: int = 0) -> list[TurningSequence]:
        """The best sequence over all orientations, and those of more moves with wider margins.

        Args:
            extra: finger moves beyond the fewest.

        Raises:
            InvalidInput: In space, where directions of the load are sampled.
        """
        whole(extra, "extra", least=0, most=MOST_EXTRA)
        return turning_sequences(self, extra, self.least_margin)

    def plans(self, extra: int = 0) -> list[RegraspPlan]:
        """The plan of each sequence.

        Forces grow while the object turns. Where force limits leave too little room for that, sequences
        without turns in several steps are looked for, then of smaller turns, of half the size each time.

        Args:
            extra: finger moves beyond the fewest.

        Raises:
            Infeasible: Where there is none, and says why.
        """
        whole(extra, "extra", least=0, most=MOST_EXTRA)
        if extra and self.weights is not None:
            raise InvalidInput("extra trades moves against margin; leave it out, or weights")
        return planned(self, extra)

    def asking(self, min_normal: float) -> "RegraspProblem":
        """The same problem with a least normal force [N].

        Args:
            min_normal: [N].
        """
        asking = object.__new__(RegraspProblem)  # a value is its own copy
        asking.__dict__.update(self.__dict__)
        object.__setattr__(asking, "min_normal", number(min_normal, "min_normal", least=0))
        for changed in ("criteria", "setting", "graph"):  # all else that was worked out stays
            asking.__dict__.pop(changed, None)
        _ = asking.criteria, asking.graph
        return asking

    def allowing(self, force: float) -> "RegraspProblem":
        """The same problem with at least this force [N] wherever it is limited.

        Args:
            force: [N].
        """
        number(force, "force", above=0)
        start, goal = (Grasp(allowed(c, force) for c in grasp) for grasp in (self.start, self.goal))
        most = None if self.max_force is None else max(force, self.max_force)
        changed: dict[str, Any] = {"start": start, "goal": goal, "max_force": most}
        return replace(self, **changed)

    def bottleneck(self) -> Bottleneck | None:
        """What limits the way, however many moves it takes; None where there is none. Not with ``arcs``."""
        if self.arcs is not None:
            raise InvalidInput("a bottleneck is that of fingers that may touch everywhere; leave arcs out")
        return bottleneck(self.graph, *self.places)
