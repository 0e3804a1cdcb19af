"""Planning whole regrasps, of a planar object with three fingers and of a solid one with four."""

from collections.abc import Sequence
from dataclasses import fields
from typing import TYPE_CHECKING, Unpack

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench
from regrasp.outline import Outline
from regrasp.planning.regrasps.options import RegraspOptions
from regrasp.planning.regrasps.planar import RegraspProblem
from regrasp.planning.regrasps.spatial import SpaceRegraspProblem
from regrasp.plans.regrasp_plan import RegraspPlan

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh


def plan_regrasp(
    outline: "Outline | Mesh", start: Grasp, goal: Grasp, load: Wrench, **options: Unpack[RegraspOptions]
) -> RegraspPlan:
    """The regrasp of fewest finger moves, and of these the one of the widest least angle margin.

    Every step is a removal, an exchange of one of two fingers that hold for the third, or an addition, while
    the object may turn; or it turns the object alone. All three fingers turn it where it has to turn by more
    than one step may: before one leaves, after the last arrives and between. A finger moves where it goes,
    without force, to another point; exchanges between the points where the three stand need no move. Of
    sequences of as many moves and as wide a margin, to 1e-6 rad, that of fewest steps is taken, then of least
    turning. With ``weights`` the one of least cost.

    outline, start, goal, load and options (``friction`` is required; ``orientations``, ``arcs``, ``weights``,
    ...) are those of ``RegraspProblem``; with a ``Mesh`` in the place of the outline and grasps of four
    contacts those of ``SpaceRegraspProblem``: three fingers hold while the fourth moves, and the plan has
    ``rotations``.

    What is proven: every state, every path between two, and that no regrasp on the sampled points has fewer
    moves or, with as few, a wider least margin; or costs less. Points between the samples are not looked at.
    All orientations are, where nothing but the load, friction, distances and ``arcs`` limits the holds;
    ``peak_ratio`` and force limits leave several arcs of angles, of which one that is shorter than a 24th of
    the whole may be missed. ``keep``, ``weights`` and regrasps in space look at sampled orientations.

    Args:
        outline: an ``Outline``, or a ``Mesh`` in space.
        start: three contacts, in space four, relative to the centre of mass [m].
        goal: as many, at the end.
        load: a force through the centre of mass, seen from the object before it turns [N].
        **options: of ``RegraspProblem`` or ``SpaceRegraspProblem``; ``friction`` [-] is required.

    Raises:
        Infeasible: Where no sequence of holds leads from one to the other, and says why and what would make
            one possible.
        InvalidInput: For arguments that are not what they must be.
    """
    return _problem(outline, start, goal, load, options).plans()[0]


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
    return _problem(outline, start, goal, load, options).plans(extra)


def _problem(
    shape: "Outline | Mesh", start: Grasp, goal: Grasp, load: Wrench, options: RegraspOptions
) -> RegraspProblem | SpaceRegraspProblem:
    """The problem for an outline or a mesh. Raises ``InvalidInput`` for an option that it does not have."""
    from regrasp.mesh.mesh import Mesh

    if not isinstance(shape, (Outline, Mesh)):
        raise InvalidInput(f"a regrasp needs an Outline or a Mesh, got {shown(shape)}")
    kind = RegraspProblem if isinstance(shape, Outline) else SpaceRegraspProblem
    known = [field.name for field in fields(kind)][4:]
    unknown = [name for name in options if name not in known]
    if unknown or "friction" not in options:
        wrong = f"unknown option {shown(unknown[0])}" if unknown else "friction is missing"
        where = "an outline" if kind is RegraspProblem else "a mesh"
        raise InvalidInput(f"{wrong}; a regrasp on {where} takes {', '.join(known)}")
    return kind(shape, start, goal, load, **options)  # type: ignore[arg-type, misc]
