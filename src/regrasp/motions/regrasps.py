"""Whole regrasps whose free fingers have ways."""

from collections.abc import Sequence
from contextlib import suppress
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple, Unpack

import numpy as np
from numpy.typing import NDArray

from regrasp.errors import Infeasible
from regrasp.mechanics.checks import Array, ArrayLike, number, whole
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.mesh.mesh import Mesh
from regrasp.motions.plan import plan_motions
from regrasp.motions.shut_in import ShutIn
from regrasp.motions.value import Motions
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan

if TYPE_CHECKING:
    from regrasp.planning.regrasps.options import RegraspOptions

_SAME = 1e-6  # of the size of the grasps: points nearer than that are one


def plan_regrasp_motions(
    shape: Outline | Mesh,
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
) -> Motions:
    """The best regrasp whose free fingers have ways, and these: ``plan_regrasp`` with ``motions``.

    Where a finger of the best sequence finds no way, the best of those sequences is next that lack the hold
    meanwhile, or those before it, or those after it; where it is shut in by the object alone, of those that
    do not touch there. Raises ``Infeasible`` where there is no regrasp, or none of those tried has ways.
    """
    from regrasp.planning.regrasps.verbs import plan_regrasp

    radius, keep = number(tip_radius, "tip_radius", above=0), number(clearance, "clearance", above=0)
    most = whole(attempts, "attempts", least=1)
    asked: Any = options | {"min_distance": max(options.get("min_distance", 0.0), 2 * radius + keep)}
    barred = _Barred(options.get("keep"), _SAME * max(start.size, goal.size))
    waiting = [_Candidate(plan_regrasp(shape, start, goal, load, **asked), barred)]
    seen: list[RegraspPlan] = []
    first: Infeasible | None = None
    while waiting and len(seen) < most:
        best = 0 if options.get("weights") else min(range(len(waiting)), key=lambda k: waiting[k].rank)
        plan, barred = waiting.pop(best)
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
                    other = plan_regrasp(shape, start, goal, load, **asked | {"keep": less})
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
