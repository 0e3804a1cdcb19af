"""The public verb of regrasps: the best sequence, or the best whose free fingers have ways."""

from collections.abc import Sequence
from contextlib import suppress
from itertools import combinations
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, Unpack, overload

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible, InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, number, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.motions.open_ends import End, best_between, is_open
from regrasp.motions.shut_in import ShutIn
from regrasp.plans.regrasp_plan import RegraspPlan

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh
    from regrasp.motions.value import Motions
    from regrasp.outline.outline import Outline
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
    ``choose_grasp`` finds under the load, in the orientation asked for.

    With ``motions`` the best sequence is taken if its free fingers have ways (``plan_motions``). Where a
    finger of one finds none, those are next that lack the hold meanwhile, or those before it, or after it; a
    better one that has all three, in another order, is not looked at.

    What is proven: every state, every path between two, and that no regrasp on the sampled points has fewer
    moves or, with as few, a wider least margin; or costs less. Points between the samples are not looked at.
    All orientations are, where nothing but the load, friction, distances and ``arcs`` limits the holds;
    ``peak_ratio`` and force limits leave several arcs of angles, of which one that is shorter than a 24th of
    the whole may be missed. ``keep``, ``weights`` and regrasps in space look at sampled orientations.

    Args:
        outline: an ``Outline``, or a ``Mesh`` in space.
        start: three contacts, in space four, relative to the centre of mass [m]; several such grasps, or on
            an outline None, of which one is chosen.
        goal: as many, at the end; as ``start``.
        load: a force through the centre of mass, seen from the object before it turns [N].
        motions: whether the fingers' ways through the air are planned, too; the first regrasp that has them
            is then ``plan`` of what is returned.
        tip_radius: as for ``plan_motions`` [m]; needed with ``motions``, as ``clearance`` is.
        clearance: as for ``plan_motions`` [m]; fingers that hold together are apart by as much.
        speed: as for ``plan_motions``, 0.1 if not given [m/s].
        acceleration: as for ``plan_motions``, 1 if not given [m/s^2].
        capsules: as for ``plan_motions`` [m].
        attempts: with ``motions``, how many sequences are tried, 50 if not given.
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

    Where a finger of the best sequence finds no way, the best of those sequences is next that lack the hold
    meanwhile, or those before it, or those after it; where it is shut in by the object alone, of those that
    do not touch there. Raises ``Infeasible`` where there is no regrasp, or none of those tried has ways.
    """
    from regrasp.motions.plan import plan_motions
    from regrasp.planning.regrasps.verbs import plan_regrasp as planned

    radius, keep = number(tip_radius, "tip_radius", above=0), number(clearance, "clearance", above=0)
    most = whole(attempts, "attempts", least=1, most=MOST_ATTEMPTS)
    asked: Any = options | {"min_distance": max(options.get("min_distance", 0.0), 2 * radius + keep)}
    best = planned(shape, start, goal, load, **asked)
    waiting = [_Candidate(best, _Barred(options.get("keep"), _SAME * max(start.size, goal.size)))]
    seen: list[RegraspPlan] = []
    first: Infeasible | None = None
    while waiting and len(seen) < most:
        first_in_rank = min(range(len(waiting)), key=lambda k: waiting[k].rank)
        plan, barred = waiting.pop(0 if options.get("weights") else first_in_rank)
        seen.append(plan)
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
            if _for_good(error.certificate, start, goal, barred.near):
                raise
            first = first or error
            for less in barred.without(error.certificate, plan):
                with suppress(Infeasible):
                    other = planned(shape, start, goal, load, **asked | {"keep": less})
                    if other not in [*seen, *(candidate.plan for candidate in waiting)]:
                        waiting.append(_Candidate(other, less))
    assert first is not None
    raise _none(first, len(seen))


def _none(first: Infeasible, tried: int) -> Infeasible:
    return Infeasible(f"{first}; {tried} sequences were tried, and none has ways", first.certificate)


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


class _Candidate(NamedTuple):
    """A sequence that may have ways, and what it leaves out."""

    plan: RegraspPlan
    barred: "_Barred"

    @property
    def rank(self) -> tuple[int, float]:
        """The first is the best: of fewest moves, then of the widest margin."""
        return len(self.plan.moves), -self.plan.margin


class _Barred:
    """Which fingers may hold together: as the caller says, less holds that lead to a move without way.

    A finger that finds no way from a to b while H holds came from a hold with a and all but one of H, and
    goes on to one with b and all but one of H. Sequences that avoid this move lack H, or all of the former,
    or all of the latter: three searches, the best of which is next.
    """

    def __init__(self, keep: Any, near: float, holds: Sequence[Array] = ()) -> None:
        self._keep, self.near, self._holds = keep, near, tuple(holds)

    def without(self, found: ShutIn, plan: RegraspPlan) -> list["_Barred"]:
        """What else to leave out, so that the finger need not go where it is shut in."""
        contacts = {str(c.name): c.position for step in plan.steps for c in step.grasp}
        held = [contacts[name] for name in found.held]
        if found.alone:
            ways = [[found.position[None]]]
        elif found.origin != found.target:
            rest = list(combinations(held, len(held) - 1))
            ends = (contacts[found.origin], contacts[found.target])
            ways = [[np.array(held)], *([np.array([end, *some]) for some in rest] for end in ends)]
        else:  # two in one another, of whom one holds
            ways = [[np.array(held)]]
            if found.step < len(plan.steps):
                step = plan.steps[found.step]
                names = [n for n in step.grasp.names if n not in (*step.leaving, *step.arriving)]
                ways[0].append(np.array([contacts[n] for n in names]))
        return [_Barred(self._keep, self.near, (*self._holds, *way)) for way in ways]

    def __call__(self, *given: Any) -> NDArray[np.bool_]:
        points = np.stack([g for g in given if np.ndim(g) == 2], axis=1)  # (k, fingers, d), an angle left out
        allowed = np.ones(len(points), dtype=bool)
        if self._keep is not None:
            allowed &= np.asarray(self._keep(*given), dtype=bool)
        for hold in self._holds:
            away = np.linalg.norm(points[:, :, None] - hold, axis=-1)
            allowed &= ~(away.min(axis=1) <= self.near).all(axis=1)
        return allowed
