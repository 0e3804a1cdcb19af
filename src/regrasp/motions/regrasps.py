"""Whole regrasps whose free fingers have ways."""

from typing import TYPE_CHECKING, Any, Unpack

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
    """The best regrasp of ``plan_regrasp`` whose free fingers have ways, and these ways.

    The regrasp is ``plan`` of what is returned. Fingers that hold together are apart by the clearance.
    Where a finger of the best sequence is shut in, the holds in which it is are left out, and the next best
    sequence is planned.

    Args:
        shape: an ``Outline``, or a ``Mesh`` in space.
        start: as for ``plan_regrasp``.
        goal: as for ``plan_regrasp``.
        load: as for ``plan_regrasp`` [N].
        tip_radius: as for ``plan_motions`` [m].
        clearance: as for ``plan_motions`` [m].
        speed: as for ``plan_motions`` [m/s].
        acceleration: as for ``plan_motions`` [m/s^2].
        capsules: as for ``plan_motions`` [m].
        attempts: how many sequences are tried.
        **options: of ``plan_regrasp``; ``friction`` [-] is required.

    Raises:
        Infeasible: Where there is no regrasp, or none of those tried has ways; then with the finger and the
            place of the first, as ``ShutIn`` in ``certificate``.
        InvalidInput: For arguments that are not what they must be.
    """
    from regrasp.planning.regrasps.verbs import plan_regrasp

    radius, keep = number(tip_radius, "tip_radius", above=0), number(clearance, "clearance", above=0)
    most = whole(attempts, "attempts", least=1)
    barred = _Barred(options.get("keep"), _SAME * max(start.size, goal.size))
    asked: Any = options | {"min_distance": max(options.get("min_distance", 0.0), 2 * radius + keep)}
    first: Infeasible | None = None
    for tried in range(most):
        try:
            plan = plan_regrasp(shape, start, goal, load, **asked)
        except Infeasible as error:
            if first is None:
                raise
            raise _none(first, tried) from error
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
            barred.add(error.certificate, plan)
            asked["keep"] = barred  # not before: with a rule of ours orientations are sampled
    assert first is not None
    raise _none(first, most)


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


class _Barred:
    """Which fingers may hold together: as the caller says, less the holds in which one found no way."""

    def __init__(self, keep: Any, near: float) -> None:
        self._keep, self.near = keep, near
        self._holds: list[Array] = []

    def add(self, found: ShutIn, plan: RegraspPlan) -> None:
        """Leave out the holds with a place that is shut in by itself, else those of the step or the pause."""
        contacts = {str(c.name): c.position for step in plan.steps for c in step.grasp}
        if found.alone:
            self._holds.append(found.position[None])
            return
        self._holds.append(np.array([contacts[name] for name in found.held]))
        if found.origin == found.target and found.step < len(
            plan.steps
        ):  # two in one another, of whom one holds
            step = plan.steps[found.step]
            held = [n for n in step.grasp.names if n not in (*step.leaving, *step.arriving)]
            self._holds.append(np.array([contacts[n] for n in held]))

    def __call__(self, *given: Any) -> NDArray[np.bool_]:
        points = np.stack([g for g in given if np.ndim(g) == 2], axis=1)  # (k, fingers, d), an angle left out
        allowed = np.ones(len(points), dtype=bool)
        if self._keep is not None:
            allowed &= np.asarray(self._keep(*given), dtype=bool)
        for hold in self._holds:
            away = np.linalg.norm(points[:, :, None] - hold, axis=-1)
            allowed &= ~(away.min(axis=1) <= self.near).all(axis=1)
        return allowed
