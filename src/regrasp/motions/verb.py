"""The public verb of regrasps: sequences of holds, and if asked for with the ways of the free fingers."""

from typing import TYPE_CHECKING, Any, Literal, Unpack, overload

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import ArrayLike
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.wrench import Wrench

if TYPE_CHECKING:
    from regrasp.mesh.mesh import Mesh
    from regrasp.motions.value import Motions
    from regrasp.outline.outline import Outline
    from regrasp.planning.regrasps.options import RegraspOptions
    from regrasp.plans.regrasp_plan import RegraspPlan


@overload
def plan_regrasp(
    outline: "Outline | Mesh",
    start: Grasp,
    goal: Grasp,
    load: Wrench,
    *,
    motions: Literal[False] = False,
    **options: Unpack["RegraspOptions"],
) -> "RegraspPlan": ...


@overload
def plan_regrasp(
    outline: "Outline | Mesh",
    start: Grasp,
    goal: Grasp,
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
    start: Grasp,
    goal: Grasp,
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
    ...) are those of ``RegraspProblem``; with a ``Mesh`` in the place of the outline and grasps of four
    contacts those of ``SpaceRegraspProblem``: three fingers hold while the fourth moves, and the plan is a
    ``SpaceRegraspPlan``.

    With ``motions`` the best sequence is taken whose free fingers have ways (``plan_motions``). Where a
    finger of one finds none, those are next that lack the hold meanwhile, or those before it, or after it.

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
        motions: whether the fingers' ways through the air are planned, too; the best regrasp that has them is
            then ``plan`` of what is returned.
        tip_radius: as for ``plan_motions`` [m]; needed with ``motions``, as ``clearance`` is.
        clearance: as for ``plan_motions`` [m]; fingers that hold together are apart by as much.
        speed: as for ``plan_motions``, 0.1 if not given [m/s].
        acceleration: as for ``plan_motions``, 1 if not given [m/s^2].
        capsules: as for ``plan_motions`` [m].
        attempts: with ``motions``, how many sequences are tried, 50 if not given.
        **options: of ``RegraspProblem`` or ``SpaceRegraspProblem``; ``friction`` [-] is required.

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
    if not motions:
        if given:
            raise InvalidInput(f"{next(iter(given))} is of ways through the air; give motions=True with it")
        from regrasp.planning.regrasps.verbs import plan_regrasp as planned

        return planned(outline, start, goal, load, **options)
    missing = [name for name in ("tip_radius", "clearance") if name not in given]
    if missing:
        raise InvalidInput(f"motions=True needs {' and '.join(missing)} [m]")
    from regrasp.motions.regrasps import plan_regrasp_motions

    return plan_regrasp_motions(outline, start, goal, load, **given, **options)
