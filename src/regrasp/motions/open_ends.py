"""Regrasps of which an end is left open: the best of those between sets of grasps."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from itertools import permutations, product
from math import inf
from typing import TYPE_CHECKING, Any

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, function, number, rotation
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.plans.regrasp_plan import RegraspPlan

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh

End = Grasp | Iterable[Grasp] | None
"""One grasp, several of which one is taken, or None for those of least force that the shape has."""
_FINGERS = 3  # in space they hold while a fourth moves
_MORE_IN_SPACE = 1  # grasps besides the best
_FOURTHS = 40  # points where a fourth finger may be
_APART = 0.05  # of the size: no nearer to the three
_BOXES = 2000  # of a search whose bound knows nothing of what is kept
MOST_ENDS = 100


def is_open(end: End) -> bool:
    """Whether an end is to be chosen."""
    return not isinstance(end, Grasp)


def best_between(
    planned: Callable[[Grasp, Grasp], Any],
    shape: Any,
    start: End,
    goal: End,
    load: Wrench,
    options: dict[str, Any],
) -> Any:
    """The regrasp of fewest moves between two sets of grasps, and of these the one of the widest margin.

    ``Infeasible`` where none of them has one.
    """
    if options.get("weights") is not None:
        raise InvalidInput(
            "weights compare sequences between two grasps; give one start and one goal with them"
        )
    turn = number(options.get("goal_orientation", 0.0), "goal_orientation")
    if isinstance(load, Wrench) and (load.torque.any() or not load.force.any()):
        raise InvalidInput(f"load of a regrasp must be a force through the centre of mass, got {shown(load)}")
    starts = _grasps(start, "start", shape, load, options)
    goals = _grasps(goal, "goal", shape, _seen_at_the_end(load, turn, options), options)
    if len(starts) * len(goals) > MOST_ENDS:
        raise InvalidInput(
            f"{len(starts)} starts and {len(goals)} goals are more than {MOST_ENDS} pairs; give fewer"
        )
    found: list[Any] = []
    refused: list[Infeasible] = []
    for one, other in product(starts, goals):
        try:
            found.append(planned(one, other))
        except Infeasible as error:
            refused.append(error)
    if found:
        return min(found, key=_rank)
    first = refused[0]
    others = len(refused) - 1
    more = f"; nor for {others} other pair{'s' * (others > 1)} of grasps" if others else ""
    raise Infeasible(f"{first}{more}", first.certificate)


def _rank(found: Any) -> tuple[int, float]:
    plan = found if isinstance(found, RegraspPlan) else found.plan
    return len(plan.moves), -plan.margin


def _seen_at_the_end(load: Wrench, turn: float, options: dict[str, Any]) -> Wrench:
    """The load as the object sees it where it ends."""
    if not isinstance(load, Wrench):  # which is refused
        return load
    if load.dimension == 3 and options.get("goal_rotation") is not None:
        back = rotation(options["goal_rotation"], "goal_rotation").T
        return Wrench(back @ load.force, back @ load.torque)
    return load if turn == 0 or load.dimension == 3 else load.rotated(-turn)


def _grasps(end: End, what: str, shape: Any, load: Wrench, options: dict[str, Any]) -> list[Grasp]:
    if isinstance(end, Grasp):
        return [end]
    if end is None:
        return _chosen(what, shape, load, options)
    try:
        grasps = list(end)
    except TypeError:
        grasps = []
    if not grasps or not all(isinstance(grasp, Grasp) for grasp in grasps):
        raise InvalidInput(f"{what} must be a Grasp, several of them, or None for any; got {shown(end)}")
    return grasps


def _chosen(what: str, shape: Any, load: Wrench, options: dict[str, Any]) -> list[Grasp]:
    """The grasps of least largest normal force, in space of least largest force, a few that differ."""
    from regrasp.mesh.mesh import Mesh
    from regrasp.planning.placement.choosing import choose_grasp

    if "friction" not in options:
        raise InvalidInput(f"friction is needed to choose {what}; give the coefficient of the candidates")
    if isinstance(shape, Mesh):
        if ignored := [name for name in ("keep", "arcs") if options.get(name) is not None]:
            raise InvalidInput(
                f"{' and '.join(ignored)} cannot be kept by a {what} that is chosen on a mesh; give a {what}"
            )
        few = choose_grasp(
            shape,
            _FINGERS,
            load,
            friction=options["friction"],
            objective="peak",
            tolerance=0.01,
            min_distance=options.get("min_distance") or None,
        )
        threes = [few.grasp, *(other.grasp for other in few.others)]
        fours = [_with_a_fourth(shape, three, load, options) for three in threes]
        found_some = [four for four in fours if four is not None]
        if not found_some:
            raise Infeasible(f"no place for a fourth finger was found beside the three chosen for {what}")
        return found_some[: 1 + _MORE_IN_SPACE]
    return _chosen_on_outline(what, shape, load, options)


def _chosen_on_outline(what: str, outline: Any, load: Wrench, options: dict[str, Any]) -> list[Grasp]:
    """The grasps of least largest normal force, each finger on its arc, every two as ``keep`` allows."""
    from regrasp.planning.placement.choosing import choose_grasp

    own = _OwnArcs(outline, options.get("arcs"))
    if options.get("keep") is not None:
        function(options["keep"], "keep", "a function of first points, second points and an angle", 3)
    keep, turn = options.get("keep"), float(options.get("goal_orientation", 0.0)) if what == "goal" else 0.0

    def may(first: Array, second: Array, _: float) -> Any:
        allowed = None if keep is None else keep(first, second, turn)
        if own.arcs is None or (allowed is not None and np.shape(allowed) != (len(first),)):
            return allowed  # and is refused
        reached = own.of_two(first, second)
        return reached if allowed is None else reached & np.asarray(allowed, dtype=bool)

    found = choose_grasp(
        outline,
        _FINGERS,
        load,
        friction=options["friction"],
        objective="peak_normal",
        max_force=options.get("max_force"),
        min_distance=options.get("min_distance") or None,
        keep=may if (constrained := keep is not None or own.differ) else None,
        arcs=own.stretches,
        tolerance=0.01,
        most_boxes=_BOXES if constrained else None,
    )
    grasps = [found.grasp, *(other.grasp for other in found.others)]
    placed = [grasp for grasp in map(own.placed, grasps) if grasp is not None]
    if not placed:
        raise Infeasible(f"no {what} was found among {len(grasps)} whose fingers are on their arcs; give one")
    return placed


class _OwnArcs:
    """The arcs of fingers on an outline, if any."""

    def __init__(self, outline: Any, arcs: Any) -> None:
        from regrasp.planning.regrasps.settings.arcs import arc_lengths, on_arcs, stretches

        self.arcs = arcs
        every = None if arcs is None else stretches(arcs, outline.length)
        self.stretches = None if every is None else every.tolist()
        self.differ = arcs is not None and not all(np.array_equal(arc, arcs[0]) for arc in arcs)

        known: dict[bytes, Any] = {}

        def allowed(points: Array) -> Any:
            new = {p.tobytes(): p for p in points if p.tobytes() not in known}
            if new:
                there = on_arcs(arcs, arc_lengths(outline, np.array(list(new.values()))), outline.length)
                known.update(zip(new, there.T, strict=True))
            return np.array([known[p.tobytes()] for p in points]).T

        self._allowed = allowed

    def of_two(self, first: Array, second: Array) -> Any:
        """Which of points (m, 2) and (m, 2) two fingers may be at."""
        one, other = np.split(self._allowed(np.vstack([first, second])), 2, axis=1)
        return np.any([one[f] & other[g] for f, g in permutations(range(_FINGERS), 2)], axis=0)

    def placed(self, grasp: Grasp) -> Grasp | None:
        """The grasp in an order in which each finger is on its arc; None where there is none."""
        if self.arcs is None:
            return grasp
        allowed = self._allowed(grasp.positions)
        for way in permutations(range(_FINGERS)):
            if allowed[range(_FINGERS), way].all():
                return Grasp([grasp[i] for i in way])
        return None


def _with_a_fourth(shape: "Mesh", three: Grasp, load: Wrench, options: dict[str, Any]) -> Grasp | None:
    """Three fingers and a fourth, of some points where it makes the largest force least; None for none."""
    from regrasp.planning.states.choosing import choose_state

    apart = max(options.get("min_distance", 0.0), _APART * float(shape.size.max()))
    best, found = inf, None
    for contact in shape.contacts(_FOURTHS, friction=options["friction"]):
        if np.linalg.norm(three.positions - contact.position, axis=1).min() < apart:
            continue
        four = Grasp([*three, replace(contact, name=f"F{_FINGERS + 1}")])
        try:
            value = choose_state(four, load, "peak").value
        except Infeasible:
            continue
        if value < best * (1 - 1e-6):
            best, found = value, four
    return found
