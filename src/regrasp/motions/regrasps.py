"""The public verb of regrasps: the best sequence, or the best whose free fingers have ways."""

from typing import TYPE_CHECKING, Any, Literal, Unpack, overload

import numpy as np

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import ArrayLike, number, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.motions.open_ends import End, best_between, is_open
from regrasp.motions.shut_in import ShutIn
from regrasp.plans.regrasp_plan import RegraspPlan

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh
    from regrasp.motions.value import Motions
    from regrasp.outline.outline import Outline
    from regrasp.planning.holds.barred import Barred
    from regrasp.planning.regrasps.options import RegraspOptions

MOST_ATTEMPTS = 10_000
"""Sequences that are tried at the most."""
_SAME = 1e-6  # of the size of the grasps: points nearer than that are one


@overload
def plan_regrasp(
    outline: "Outline | Mesh",
    start: End,
    goal: End,
    load: Wrench,
    *,
    motions: Literal[False] = False,
    **options: Unpack["RegraspOptions"],
) -> RegraspPlan: ...


@overload
def plan_regrasp(
    outline: "Outline | Mesh",
    start: End,
    goal: End,
    load: Wrench,
    *,
    motions: Literal[True],
    tip_radius: float,
    clearance: float,
    speed: float = 0.1,
    acceleration: float = 1.0,
    capsules: ArrayLike | None = None,
    attempts: int = 50,
    **options: Unpack["RegraspOptions"],
) -> "Motions": ...


def plan_regrasp(
    outline: "Outline | Mesh",
    start: End,
    goal: End,
    load: Wrench,
    *,
    motions: bool = False,
    tip_radius: float | None = None,
    clearance: float | None = None,
    speed: float | None = None,
    acceleration: float | None = None,
    capsules: ArrayLike | None = None,
    attempts: int | None = None,
    **options: Any,
) -> "RegraspPlan | Motions":
    """The regrasp of fewest finger moves, and of these the one of the widest least angle margin.

    Every step is a removal, an exchange of one of two fingers that hold for the third, or an addition, while
    the object may turn; or it turns the object alone. All three fingers turn it where it has to turn by more
    than one step may: before one leaves, after the last arrives and between. A finger moves where it goes,
    without force, to another point; exchanges between the points where the three stand need no move. Of
    sequences of as many moves and as wide a margin, to 1e-6 rad, that of fewest steps is taken, then of least
    turning. With ``weights`` the one of least cost.

    outline, start, goal, load and options (``friction`` is required; ``orientations``, ``arcs``, ``weights``,
    ...) are those of ``RegraspProblem``. With a ``Mesh`` in the place of the outline and grasps of four
    contacts three fingers hold while the fourth moves, and the plan has ``rotations``.

    An end may be left open, as several grasps or None: the regrasp of fewest moves is taken, and of these the
    one of the widest margin. None stands for the few grasps of least largest normal force that
    ``choose_grasp`` finds under the load, in the orientation asked for, every finger on its arc and every two
    where ``keep`` allows it; on a mesh, where these two are refused with it, for three fingers of least
    largest force and a fourth where, of 40 points, it makes that least.

    With ``motions`` the best sequence is taken if its free fingers have ways (``plan_motions``). Where a
    finger finds none from one contact to another while others hold, the best of all sequences without this
    move is next, among sampled orientations. Fingers with capsules of their own are taken as alike in that.

    What is proven: every state, every path between two, and that no regrasp on the sampled points has fewer
    moves or, with as few, a wider least margin; or costs less. Points between the samples are not looked at.
    All orientations are, where nothing but the load, friction, distances and ``arcs`` limits the holds;
    ``peak_ratio`` and force limits leave several arcs of angles, of which one that is shorter than a 24th of
    the whole may be missed. ``keep``, ``weights`` and regrasps in space look at sampled orientations.

    Args:
        outline: an ``Outline``, or a ``Mesh`` in space.
        start: three contacts, in space four, relative to the centre of mass [m]; several such grasps, or
            None, of which one is chosen.
        goal: as many, at the end; as ``start``.
        load: a force through the centre of mass, seen from the object before it turns [N].
        motions: whether the fingers' ways through the air are planned, too; the first regrasp that has them
            is then ``plan`` of what is returned.
        tip_radius: as for ``plan_motions`` [m]; needed with ``motions``, as ``clearance`` is.
        clearance: as for ``plan_motions`` [m]; fingers that hold together are apart by as much.
        speed: as for ``plan_motions``, 0.1 if not given [m/s].
        acceleration: as for ``plan_motions``, 1 if not given [m/s^2].
        capsules: as for ``plan_motions`` [m].
        attempts: with ``motions``, how many sequences are tried at the most, 50 if not given.
        **options: of ``RegraspProblem``; ``friction`` [-] is required.

    Returns:
        The plan, or with ``motions`` a ``Motions``, whose ``plan`` it is.

    Raises:
        Infeasible: Where no sequence of holds leads from one to the other, and says why and what would make
            one possible; or none of those tried has ways, with ``ShutIn`` of the first in ``certificate``.
        InvalidInput: For arguments that are not what they must be.
    """
    ways = {
        "tip_radius": tip_radius,
        "clearance": clearance,
        "speed": speed,
        "acceleration": acceleration,
        "capsules": capsules,
        "attempts": attempts,
    }
    given: dict[str, Any] = {name: value for name, value in ways.items() if value is not None}
    if not isinstance(motions, bool):
        raise InvalidInput(f"motions must be True or False, got {shown(motions)}")
    if is_open(start) or is_open(goal):

        def between(one: Grasp, other: Grasp) -> Any:
            return plan_regrasp(outline, one, other, load, motions=motions, **given, **options)  # type: ignore[call-overload]

        found: RegraspPlan | Motions = best_between(between, outline, start, goal, load, options)
        return found
    assert isinstance(start, Grasp)
    assert isinstance(goal, Grasp)
    if not motions:
        if given:
            raise InvalidInput(f"{next(iter(given))} is of ways through the air; give motions=True with it")
        from regrasp.planning.regrasps.verbs import plan_regrasp as planned

        return planned(outline, start, goal, load, **options)
    missing = [name for name in ("tip_radius", "clearance") if name not in given]
    if missing:
        raise InvalidInput(f"motions=True needs {' and '.join(missing)} [m]")
    return plan_regrasp_motions(outline, start, goal, load, **given, **options)


def plan_regrasp_motions(
    shape: "Outline | Mesh",
    start: Grasp,
    goal: Grasp,
    load: Wrench,
    *,
    tip_radius: float,
    clearance: float,
    speed: float = 0.1,
    acceleration: float = 1.0,
    capsules: ArrayLike | None = None,
    attempts: int = 50,
    **options: Unpack["RegraspOptions"],
) -> "Motions":
    """The best regrasp whose free fingers have ways, and these: ``plan_regrasp`` with ``motions``.

    Where a finger of the best sequence finds no way, the best of those without this move is next, and so on.
    Raises ``Infeasible`` where there is no regrasp, or none has ways.
    """
    from regrasp.motions.plan import plan_motions
    from regrasp.planning.holds.barred import Barred
    from regrasp.planning.regrasps.planned import planned
    from regrasp.planning.regrasps.verbs import problem_of

    radius, keep = number(tip_radius, "tip_radius", above=0), number(clearance, "clearance", above=0)
    most = whole(attempts, "attempts", least=1, most=MOST_ATTEMPTS)
    asked: Any = options | {"min_distance": max(options.get("min_distance", 0.0), 2 * radius + keep)}
    problem = problem_of(shape, start, goal, load, asked)
    places = {str(contact.name): place for place, contact in enumerate(problem.contacts)}
    plan, barred = problem.plans()[0], Barred()
    first: Infeasible | None = None
    for tried in range(1, most + 1):
        try:
            return plan_motions(
                plan,
                shape,
                tip_radius=radius,
                clearance=keep,
                speed=speed,
                acceleration=acceleration,
                capsules=capsules,
            )
        except Infeasible as error:
            if _for_good(error.certificate, start, goal, _SAME * max(start.size, goal.size)):
                raise
            first = first or error
            more = barred | bars(error.certificate, places)
        if more == barred:
            raise _none(
                first, "it is barred already, but was taken again; it is not proven that there is none"
            )
        barred = more
        if tried == most:
            raise _none(first, f"{tried} sequences were tried, and none has ways; give more attempts")
        try:
            plan = planned(problem, 0, barred)[0]
        except Infeasible as none:
            why = f"{tried} sequences were tried, and none has ways; without such moves {none}"
            raise _none(first, why) from None
    raise AssertionError("attempts are at least one")


def _none(first: Infeasible, why: str) -> Infeasible:
    return Infeasible(f"{first}; {why}", first.certificate)


def _for_good(found: ShutIn, start: Grasp, goal: Grasp, near: float) -> bool:
    """Whether it is so in every sequence: of one contact of the ends, or of two of the same end."""
    ends = [np.linalg.norm(end.positions - found.position, axis=1).min() <= near for end in (start, goal)]
    if found.alone:
        return any(ends)
    if found.other is None:
        return False
    return any(
        here and np.linalg.norm(end.positions - found.other, axis=1).min() <= near
        for here, end in zip(ends, (start, goal), strict=True)
    )


def bars(found: ShutIn, places: dict[str, int]) -> "Barred":
    """What a finger without a way proves, on contacts by their places.

    One that is shut in by the object alone is at this contact in no stance, two that are in one another are
    in none together. Where another holds too near, nobody comes or leaves while it does; else the finger does
    not go between these two contacts, in neither direction, while the same others hold.
    """
    from regrasp.planning.holds.barred import Barred

    ends = frozenset((places[found.origin], places[found.target]))
    held = frozenset(places[name] for name in found.held)
    if found.alone:
        return Barred(together=frozenset([frozenset([places[found.place]])]))
    if found.other is not None:
        return Barred(together=frozenset([held]))
    if found.near is not None:
        ends, held = frozenset([places[found.place]]), frozenset([places[found.near]])
    return Barred(moves=frozenset([(ends, held)]))
