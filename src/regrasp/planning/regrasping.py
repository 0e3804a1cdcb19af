"""Planning whole regrasps of a planar object."""

from typing import Unpack

from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.outline import Outline
from regrasp.planning.regrasp_plan import RegraspPlan
from regrasp.planning.regrasp_problem import RegraspOptions, RegraspProblem


def plan_regrasp(
    outline: Outline, start: Grasp, goal: Grasp, load: Wrench, **options: Unpack[RegraspOptions]
) -> RegraspPlan:
    """The regrasp of fewest finger moves, and of these the one of the widest least angle margin.

    Between the first removal and the last addition every step exchanges one of two fingers that hold for the
    third, while the object may turn, or turns the object in one hold. A finger moves where it goes, without
    force, to another point; exchanges between the points where the three stand need no move. Of sequences of
    as many moves and as wide a margin, to 1e-6 rad, that of fewest steps is taken, then of least turning.
    With ``weights`` the one of least cost.

    outline, start, goal, load and options (``friction`` is required; ``orientations``, ``arcs``, ``weights``,
    ...) are those of ``RegraspProblem``.

    What is proven: every state, every path between two, and that no regrasp on the sampled points and
    orientations has fewer moves or, with as few, a wider least margin; or costs less. Points and orientations
    between the samples are not looked at.
    Raises ``Infeasible`` where no sequence of holds leads from one to the other, and says why and what would
    make one possible; ``InvalidInput`` for arguments that are not what they must be.
    """
    return RegraspProblem(outline, start, goal, load, **options).plans()[0]


def plan_regrasps(
    outline: Outline,
    start: Grasp,
    goal: Grasp,
    load: Wrench,
    *,
    extra: int = 0,
    **options: Unpack[RegraspOptions],
) -> list[RegraspPlan]:
    """The trade-off between finger moves and margin, as a list of plans.

    First that of ``plan_regrasp``, then those of up to ``extra`` more moves, each with a wider least margin
    than the one before it. Arguments and errors are those of ``plan_regrasp``; ``weights`` have no trade-off.
    """
    return RegraspProblem(outline, start, goal, load, **options).plans(extra)
