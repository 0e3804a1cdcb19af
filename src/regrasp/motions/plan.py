"""The verb: ways of free fingers through the air."""

from itertools import pairwise

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.mechanics.checks import Array, ArrayLike, number, numbers_in
from regrasp.mechanics.contact import Contact
from regrasp.mechanics.value import numbers
from regrasp.mesh.mesh import Mesh
from regrasp.motions.air import Air
from regrasp.motions.stands import stops
from regrasp.motions.value import Motion, Motions
from regrasp.outline.outline import Outline
from regrasp.plans.regrasp_plan import RegraspPlan
from regrasp.plans.transition import Transition


def plan_motions(
    plan: Transition | RegraspPlan,
    shape: Outline | Mesh,
    *,
    tip_radius: float,
    clearance: float,
    speed: float = 0.1,
    acceleration: float = 1.0,
    capsules: ArrayLike | None = None,
) -> Motions:
    """The ways of the fingers that are free, from contact to contact in the object's frame.

    Each finger lifts off along the normal, goes around the object and the others, and touches down along the
    normal. Fingers move at once where they keep clear in time, one after the other where they cross, one
    aside where they change places; one that is in the air moves while the others take a step. A finger that
    is not needed stands off its last contact. In the plane ways are the shortest around the offset outline,
    in space those of a roadmap off the surface, drawn tight. Away from its contacts a finger keeps the
    clearance from the object and the others: proven of the rounded way's hulls, in space and in time by
    distances that change no faster than points move. Speed and acceleration, in the object's frame, stay
    within limits all the way.

    Args:
        plan: a ``Transition`` or a ``RegraspPlan``.
        shape: the object it was planned for: an ``Outline`` in the plane, a ``Mesh`` in space.
        tip_radius: of the fingertips, discs or spheres [m].
        clearance: that fingers keep from the object and from one another [m].
        speed: the largest, of a tip in the object's frame [m/s].
        acceleration: the largest, of a tip in the object's frame [m/s^2].
        capsules: (d,) from each tip's centre to the other end of its finger, a capsule of the tips' radius,
            in the object's frame, with which fingers turn [m]; or (k, d), one for each finger. Discs and
            spheres if absent.

    Raises:
        InvalidInput: For a plan in the plane with a mesh, or one in space with an outline; for a contact that
            is farther from the shape than the clearance, as of another object or in other units.
        Infeasible: With the finger and the place where it is shut in, or where two fingers are in one
            another.
    """
    if not isinstance(plan, (Transition, RegraspPlan)):
        raise InvalidInput(f"ways are those of a Transition or a RegraspPlan, got {shown(plan)}")
    steps = (plan,) if isinstance(plan, Transition) else plan.steps
    dimension = steps[0].grasp.dimension
    if not isinstance(shape, Outline if dimension == 2 else Mesh):
        wanted = "plane, around an Outline" if dimension == 2 else "space, around a Mesh"
        raise InvalidInput(f"ways of this plan are in the {wanted}, got {shown(shape)}")
    radius, keep = number(tip_radius, "tip_radius", above=0), number(clearance, "clearance", above=0)
    limits = number(speed, "speed", above=0), number(acceleration, "acceleration", above=0)
    places = list(stops(plan, steps))
    bars = _capsules(capsules, len(places[0]), dimension)
    for contact in {c.name: c for step in steps for c in step.grasp}.values():
        _refuse_off(contact, shape, keep)
    air = Air(steps, shape, radius, keep, bars)
    for k, stop in enumerate(places[1:-1]):
        air.check_held(k, stop)
    motions: list[Motion] = []
    begun = over = 0.0  # of the step before
    for k, (before, after) in enumerate(pairwise(places)):
        motions += air.moved(k, before, after, limits, (begun, over))
        begun = max([over, *(m.end for m in motions if m.step == k)])
        over = begun + (steps[k].duration if k < len(steps) else 0.0)
    tips = np.array([[air.stand(i, n).tip(on) for i, (n, on) in enumerate(p)] for p in places[1:]])
    touching = np.array([[on for _, on in p] for p in places[1:]])
    return Motions(plan, tuple(motions), tips, touching, radius, keep, air.capsules)


def _refuse_off(contact: Contact, shape: Outline | Mesh, keep: float) -> None:
    """Raise ``InvalidInput`` unless a contact is on its shape, to the clearance."""
    point = contact.position + shape.centre_of_mass
    if isinstance(shape, Mesh):
        near = shape.nearest(point) - shape.centre_of_mass
    else:
        near = shape.points(shape.nearest(point))
    off = float(np.linalg.norm(contact.position - near))
    if off > keep:
        what = "mesh" if isinstance(shape, Mesh) else "outline"
        raise InvalidInput(
            f"{contact.name} at {numbers(contact.position)} is {off:.3g} away from the {what}, farther than "
            f"the clearance {keep:.3g}; give the {what} that the plan was made for, in the same units"
        )


def _capsules(given: ArrayLike | None, fingers: int, dimension: int) -> Array:
    """(k, d) one for each finger."""
    if given is None:
        return np.zeros((fingers, dimension))
    result = numbers_in(given, "capsules must be numbers")
    if result.shape not in ((dimension,), (fingers, dimension)) or not np.isfinite(result).all():
        raise InvalidInput(
            f"capsules must be finite, of shape ({dimension},), or ({fingers}, {dimension}) for one of each "
            f"finger, got {shown(given)}"
        )
    return np.broadcast_to(result, (fingers, dimension)).copy()
