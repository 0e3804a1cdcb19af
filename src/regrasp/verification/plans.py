"""The verdict on whole plans.

On the straight path f(t) lies on the segment between the ends. With one grasp and one load all conditions
hold at every t when they hold at both ends and 0 <= T(t) <= 1; a B-spline stays within its control values.

On a course forces and loads are linear between instants, so equilibrium, cones, limits and least normal
forces hold at every t when they hold at the instants, and a rate is one number on each stretch.
"""

from collections.abc import Callable
from math import inf
from typing import Any, cast

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import ArrayLike, function, number
from regrasp.mechanics.loads.load_set import LoadSet
from regrasp.mechanics.wrench import Wrench
from regrasp.verification.exact import check_state, least_angle
from regrasp.verification.float_filter import Checked, check_rows
from regrasp.verification.kinds import check_claim, check_regrasp, check_transition, is_there, is_transition
from regrasp.verification.load_gap import check_load
from regrasp.verification.placed.chosen_grasps import verify_chosen, verify_proof
from regrasp.verification.placed.faces.regions import FaceRegions, verify_face_regions
from regrasp.verification.placed.protocol import Chosen, Proof
from regrasp.verification.placed.regions import Regions, verify_regions
from regrasp.verification.protocols import Course, Plan
from regrasp.verification.records import check_idle, check_record
from regrasp.verification.refusals.cuts import Cut, verify_cut
from regrasp.verification.refusals.outline_cuts import OutlineCut, verify_outline_cut
from regrasp.verification.regrasps import Regrasp, check_joints, of_steps
from regrasp.verification.shapes import check_course_form, check_names, check_scaling, check_shapes
from regrasp.verification.turning_steps import check_turn
from regrasp.verification.verdict import Verification
from regrasp.verification.withstood.plans import Asked, check_promised, check_withstood

_NO_FORM = inf, 0.0, -inf  # residual, angle and slack of what cannot be judged


def verify(
    plan: Plan | Regrasp | Chosen | Proof | Regions | Cut | OutlineCut,
    load: Callable[[float], Wrench] | None = None,
    *,
    curvature: float | None = None,
    disturbance: LoadSet | None = None,
    stiffness: ArrayLike | None = None,
    friction: float | None = None,
    position: ArrayLike | None = None,
    surface: ArrayLike | None = None,
    early_loss: bool = False,
) -> Verification:
    """Check a transition in exact arithmetic: the ends, the path between them and the idle finger.

    Of a regrasp every step is checked, and every joint between two steps; of a chosen grasp its states, and
    every box of the proof that no placement is better; of a cut that no hold crosses it.

    Args:
        plan: a transition, a regrasp, a chosen grasp or contact regions, whoever made it; or the proof of a
            bound alone, or of no regrasp, a ``RegraspCut``
            or an ``OutlineCut``.
        load: a function of time [s] that the plan was made for. The plan's load is linear between its
            instants and is what the forces balance exactly; the function may differ from it between them.
            That gap must be less than the margins can take: forces that balance the function must exist
            inside cones and limits.
        curvature: a bound on the second derivative of the load, |F''| and |tau''| / grasp.size [N/s^2], which
            proves the gap (a measured one that is larger refutes it). Without it the gap is measured between
            the instants, and the verdict says so.
        disturbance: load deviations that must be withstood on top of the load at every instant, forces
            changing by R d with the stiffness of the fingers that stay (docs/robustness.md); decided for
            every member, or one is named that is not withstood.
        stiffness: of the fingers, as in ``Criteria``, by the contacts in play, of a regrasp by the fingers in
            the order of the start [N/m]; all alike if not given.
        friction: the factor on all friction coefficients, torsions with them, that is judged [-]; 1 if not
            given.
        position: (n,) or (m, n), in space (n, 2) or (m, n, 2): contacts off along their tangents [m]; each of
            m rows is judged by itself.
        surface: curvature of the surface at the contacts [1/m], a number or (n,), positive where it bulges
            out; flat if not given.
        early_loss: whether all this holds, too, after a finger that leaves or arrives lost contact.

    Raises:
        InvalidInput: For what is no plan, no load function or no curvature.
    """
    if any(is_there(plan, name) for name in ("certificate", "twists", "corners", "patches", "reached")):
        more_asked = (load, curvature, disturbance, stiffness, friction, position, surface)
        if early_loss or any(value is not None for value in more_asked):
            raise InvalidInput(
                "a chosen grasp or a cut says itself what it is about: verify takes nothing else beside it"
            )
        check_claim(plan)
        if hasattr(plan, "reached") and hasattr(plan, "boxes"):
            return verify_outline_cut(cast(OutlineCut, plan))
        if hasattr(plan, "reached"):
            return verify_cut(cast(Cut, plan))
        if hasattr(plan, "patches") and hasattr(plan, "moments"):
            return verify_face_regions(cast(FaceRegions, plan))
        if hasattr(plan, "corners") and not hasattr(plan, "halves"):
            return verify_regions(cast(Regions, plan))
        if hasattr(plan, "certificate"):
            return verify_chosen(cast(Chosen, plan))
        return verify_proof(cast(Proof, plan))
    if is_there(plan, "steps", "orientations"):
        if load is not None:
            raise InvalidInput("a regrasp holds the load it was planned for; leave load out")
        if position is not None or surface is not None:
            raise InvalidInput(
                "the contacts of a regrasp change from step to step: verify position and surface step by step"
            )
        check_regrasp(plan)
        more = {"disturbance": disturbance, "friction": friction, "early_loss": early_loss}
        return _verify_regrasp(cast(Regrasp, plan), more, stiffness)
    plan = cast(Plan, plan)
    if not is_transition(plan):
        raise InvalidInput(f"verify needs a plan, got {shown(plan)}")
    check_transition(plan)
    if load is not None:
        function(load, "load", "the function of time the plan was made for")
    if load is not None and plan.turn is not None:
        raise InvalidInput("a turning path holds the load that turns with it; leave load out")
    if curvature is not None:
        if load is None:
            raise InvalidInput("curvature bounds a load function: give load as well")
        curvature = number(curvature, "curvature", least=0)
    given = disturbance, stiffness, friction, position, surface, early_loss
    asked = Asked.of(plan.start.grasp, *given)
    unnamed = check_names(plan)
    if unnamed:
        return Verification(tuple(unnamed), *_NO_FORM)
    untimed = check_scaling(plan)
    violations = check_idle(plan) + untimed
    if plan.start.grasp != plan.end.grasp:
        violations.append("start and end have different contacts")
        return Verification(tuple(violations), *_NO_FORM)
    if plan.turn is not None:
        found = check_turn(plan, plan.turn)
        if plan.course is not None:
            violations.append("a plan has a course or a turn, not both")
    else:
        found = _check_ends(plan) if plan.course is None else _check_course(plan, plan.course)
    violations += found.violations
    if found.worst_residual == inf:  # not of the form that the checks below take for granted
        return Verification(tuple(violations), *found[1:])
    violations += [] if untimed else check_record(plan)
    promises, promised = check_promised(plan, asked)
    violations += promises
    if asked is not None:
        violations += check_withstood(plan, asked)
    withstood = "; ".join(words for words in (promised, asked.words if asked else "") if words)
    gap, proven = None, False
    if load is not None:
        gap, proven, broken = check_load(plan, load, curvature)
        violations += broken
    return Verification(tuple(violations), *found[1:], gap, proven, withstood=withstood)


def _verify_regrasp(plan: Regrasp, more: dict[str, Any], stiffness: ArrayLike | None) -> Verification:
    if not plan.steps:
        return Verification(tuple(check_joints(plan)), *_NO_FORM)
    springs = of_steps(plan, stiffness)
    verdicts = [verify(step, stiffness=k, **more) for step, k in zip(plan.steps, springs, strict=True)]
    broken = [f"step {k}: {v}" for k, verdict in enumerate(verdicts, 1) for v in verdict.violations]
    if not any(map(check_shapes, plan.steps)):
        broken += check_joints(plan)
    return Verification(
        tuple(broken),
        max(verdict.worst_residual for verdict in verdicts),
        min(verdict.least_angle for verdict in verdicts),
        min(verdict.least_cone_slack for verdict in verdicts),
        withstood="; ".join(dict.fromkeys(v.withstood for v in verdicts if v.withstood)),
    )


def _check_ends(plan: Plan) -> Checked:
    broken = []
    if plan.start.load != plan.end.load:
        broken.append("start and end have different loads, so the straight path keeps no equilibrium")
    residuals, slacks, angles = [0.0], [inf], [inf]
    for label, state in (("start", plan.start), ("end", plan.end)):
        residual, slack, violations = check_state(state, label)
        residuals.append(residual)
        slacks.append(slack)
        angles.append(least_angle(state.grasp, state.forces))
        broken += violations
    return Checked(broken, max(residuals), min(angles), min(slacks))


def _check_course(plan: Plan, course: Course) -> Checked:
    times, forces, loads = course.times, course.forces, course.loads
    broken = check_course_form(plan, course)
    if broken:
        return Checked(broken, *_NO_FORM)
    if times[0] != 0 or times[-1] != plan.scaling.duration or not (times[1:] > times[:-1]).all():
        broken.append(f"the instants must rise from 0 to the duration {plan.scaling.duration!r} s")
    for label, state, k in (("start", plan.start, 0), ("end", plan.end, -1)):
        if (state.forces != forces[k]).any() or (state.load.vector != loads[k]).any():
            broken.append(f"{label}: its forces or its load are not those of the path at that instant")
    found = check_rows(plan.start.grasp, forces, loads, "instant {}")
    return found._replace(violations=broken + found.violations)
