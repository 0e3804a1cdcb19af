"""Planning whole regrasps, of a planar object with three fingers and of a solid one with four."""

from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Unpack

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.planning.regrasps.options import RegraspOptions
from regrasp.planning.regrasps.problem import RegraspProblem
from regrasp.plans.regrasp_plan import RegraspPlan

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh
    from regrasp.outline import Outline


def plan_regrasp(
    outline: "Outline | Mesh", start: Grasp, goal: Grasp, load: Wrench, **options: Unpack[RegraspOptions]
) -> RegraspPlan:
    """The best regrasp, without ways; the public verb, ``regrasp.motions.regrasps``, says what that is.

    Args:
        outline: an ``Outline``, or a ``Mesh`` in space.
        start: three contacts, in space four, relative to the centre of mass [m].
        goal: as many, at the end.
        load: a force through the centre of mass, seen from the object before it turns [N].
        **options: of ``RegraspProblem``; ``friction`` [-] is required.
    """
    return problem_of(outline, start, goal, load, options).plans()[0]


def plan_regrasps(
    outline: "Outline | Mesh",
    start: Grasp,
    goal: Grasp,
    load: Wrench,
    *,
    extra: int = 0,
    **options: Unpack[RegraspOptions],
) -> Sequence[RegraspPlan]:
    """The trade-off between finger moves and margin, as a list of plans.

    First that of ``plan_regrasp``, then those of up to ``extra`` more moves, each with a wider least margin
    than the one before it. Arguments and errors are those of ``plan_regrasp``; ``weights`` have no trade-off.

    Args:
        outline: as for ``plan_regrasp``.
        start: as for ``plan_regrasp``.
        goal: as for ``plan_regrasp``.
        load: as for ``plan_regrasp`` [N].
        extra: how many moves beyond the fewest.
        **options: as for ``plan_regrasp``.
    """
    return problem_of(outline, start, goal, load, options).plans(extra)


def problem_of(
    shape: "Outline | Mesh", start: Grasp, goal: Grasp, load: Wrench, options: RegraspOptions
) -> RegraspProblem:
    """The problem.

    Args:
        shape: an ``Outline`` or a ``Mesh``.
        start: as for ``plan_regrasp``.
        goal: as for ``plan_regrasp``.
        load: as for ``plan_regrasp`` [N].
        options: of ``RegraspProblem``.

    Raises:
        InvalidInput: For an option that it does not have.
    """
    known = [field.name for field in fields(RegraspProblem)][4:]
    unknown = [name for name in options if name not in known]
    if unknown or "friction" not in options:
        wrong = f"unknown option {shown(unknown[0])}" if unknown else "friction is missing"
        raise InvalidInput(f"{wrong}; a regrasp takes {', '.join(known)}")
    return RegraspProblem(shape, start, goal, load, **options)
