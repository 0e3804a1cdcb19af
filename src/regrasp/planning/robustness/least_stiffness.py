"""The stiffness below which a squeezed object turns out of its fingers.

Point tips that stick, forces constant in the world, an object displaced by a twist y = (v, w): the energy is

    1/2 y' [ G K G' + diag(0, B) ] y,   B = sum_i [(r_i . f_i) 1 - (r_i f_i' + f_i r_i') / 2]

and stable where that is positive definite; in the plane B = sum_i r_i . f_i. A force F of the load that acts
at a point r_L of the object adds the term of one contact. Tips of radius a roll: the point where a force acts
moves, r_i + a' n_i in the place of r_i in B, a' = a / (1 + kappa a) with the curvature kappa of the surface.
Springs K times s are stable for s above the largest eigenvalue of -diag(0, B) by G K G'.
"""

import numpy as np

from regrasp.errors import InvalidInput
from regrasp.mechanics.checks import Array, ArrayLike, array, finite, not_huge, number
from regrasp.mechanics.robust.stiffness import checked_stiffness, stiffness_matrices
from regrasp.planning.robustness.views import Subject, View, views_of


def least_stiffness(
    state_or_plan: Subject,
    tip_radius: float = 0.0,
    *,
    stiffness: ArrayLike | None = None,
    load_at: ArrayLike | None = None,
    surface: ArrayLike | None = None,
) -> float:
    """The least stiffness of all fingers with which a squeezed object stays where it is [N/m].

    Point contacts that stick; forces constant in the world, of which every squeeze turns the object away. 0
    where none is needed. Of a plan the largest of its states: straight paths by their ends, since the matrix
    is linear in the forces. A torque of the load that stays in the world counts by the symmetric part, which
    is on the safe side.

    Args:
        state_or_plan: a ``GraspState``, a ``Transition`` or a regrasp.
        tip_radius: of round fingertips, which roll [m].
        stiffness: as in ``Criteria``, by contact and direction; the result is then the least factor of it,
            without a unit. All alike and 1 if not given, so that the factor is the stiffness itself.
        load_at: (d,) the point of the object at which the load's force acts, object frame [m]; the centre of
            mass if not given. A wrench does not say it, and it matters.
        surface: curvature at the contacts [1/m], a number or (n,), positive where it bulges out; flat if not
            given. It matters where tips roll.

    Raises:
        InvalidInput: For bad input, and where the stiffness leaves the object free to move.
    """
    not_huge(number(tip_radius, "tip_radius", least=0), "tip_radius")
    springs = checked_stiffness(stiffness)
    views = views_of(state_or_plan, springs, None)
    place = None if load_at is None else array(load_at, "load_at", (views[0].grasp.dimension,))
    curved = finite(0.0 if surface is None else surface, "surface")
    return max(_factor(view, tip_radius, place, curved) for view in views)


def _factor(view: View, tip_radius: float, load_at: Array | None, surface: Array) -> float:
    grasp, d = view.grasp, view.grasp.dimension
    if surface.shape not in ((), (len(grasp),)):
        raise InvalidInput(f"surface must be one curvature or {len(grasp)}, got shape {surface.shape}")
    kappa = np.broadcast_to(surface, len(grasp))
    if (1 + kappa * tip_radius <= 0).any():
        raise InvalidInput("a tip of this radius does not fit into the hollow of the surface; see surface")
    rolled = tip_radius / (1 + kappa * tip_radius)
    arms = grasp.positions + rolled[:, None] * grasp.normals
    forces = view.state.forces[:, :d]
    if load_at is not None:
        arms, forces = np.vstack([arms, load_at]), np.vstack([forces, view.state.load.force])
    matrices = stiffness_matrices(grasp, view.stiffness, view.controlled)
    n, w = len(grasp), grasp.width
    scaled = grasp.matrix / grasp.lengths[:, None]
    held = np.einsum("pia,iab,qib->pq", scaled.reshape(-1, n, w), matrices, scaled.reshape(-1, n, w))
    values, vectors = np.linalg.eigh(held)
    if not values[0] > 1e-12 * values[-1]:
        raise InvalidInput("the fingers' stiffness leaves the object free to move, so that none is enough")
    turning = np.zeros_like(held)
    turning[d:, d:] = _second_order(arms, forces) / grasp.lengths[d] ** 2
    root = vectors / np.sqrt(values)
    return max(float(np.linalg.eigvalsh(-root.T @ turning @ root)[-1]), 0.0)


def _second_order(arms: Array, forces: Array) -> Array:
    """B, (1, 1) in the plane, (3, 3) in space [N m]."""
    along = float((arms * forces).sum())
    if arms.shape[1] == 2:
        return np.array([[along]])
    product = arms.T @ forces
    result: Array = along * np.eye(3) - (product + product.T) / 2
    return result
