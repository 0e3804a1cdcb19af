"""The verdict on a grasp chosen from a shape: its states, where it touches, and the proof of its bound."""

from fractions import Fraction
from math import atan, hypot, inf, isfinite, sin
from typing import Any, cast

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.state import GraspState
from regrasp.verification.exact import RESOLUTION, check_state, least_angle
from regrasp.verification.placed.arc_lengths import points_at
from regrasp.verification.placed.forces.limited import others_limits
from regrasp.verification.placed.meshes.areas import part_of_surface, share_on
from regrasp.verification.placed.meshes.surfaces import SurfaceProof, check_surface_proof, touches
from regrasp.verification.placed.placements import check_proof
from regrasp.verification.placed.protocol import Chosen, Proof
from regrasp.verification.placed.touching import Touching
from regrasp.verification.placed.whole_sets import answer_alike, makes_ball
from regrasp.verification.verdict import Verification

# objective: size of a force, norm of the sizes
_MEANINGS = {
    "sum_normal": ("normal", "sum"),
    "peak_normal": ("normal", "largest"),
    "peak": ("force", "largest"),
    "effort": ("force", "squares"),
    # levels at which forces below the limit must exist
    "friction_use": ("force", "largest"),
    "angle": ("force", "largest"),
    "force": ("margin", "largest"),
    "answered": ("force", "largest"),
    "wrench": ("force", "largest"),
    "wrench_ball": ("normal", "largest"),
}
_LEVELS = ("friction_use", "angle", "force", "answered", "wrench", "wrench_ball")
_LARGEST = ("angle", "force", "answered", "wrench", "wrench_ball")  # what is best as large as can be
_ANY_LOAD = ("answered", "wrench", "wrench_ball")  # their proofs have loads that no state holds
_CLOSE = 1e-9  # of a value, the same in another order of the sums


def verify_chosen(chosen: Chosen) -> Verification:
    """The verdict on a chosen grasp, proof included."""
    broken: list[str] = []
    residuals, slacks, angles = [0.0], [inf], [inf]
    proof = chosen.certificate
    if chosen.objective not in _MEANINGS:
        return Verification((f"objective {chosen.objective!r} has no bound",), inf, 0.0, -inf)
    if (proof.size, proof.norm) != _MEANINGS[chosen.objective] and not _is_without_margin(chosen, proof):
        broken.append(f"the proof is of a {proof.norm} of {proof.size}, not of {chosen.objective}")
    for i, state in enumerate(chosen.states, 1):
        if state.grasp != chosen.grasp:
            broken.append(f"state {i} is of other contacts")
            continue
        residual, slack, violations = check_state(state, f"state {i}")
        residuals.append(residual)
        slacks.append(slack)
        angles.append(least_angle(state.grasp, state.forces))
        broken += violations
        broken += _check_value(chosen, state, i)
    broken += [] if chosen.states else ["no state shows the value"]
    broken += _check_others(chosen)
    in_space = hasattr(proof, "normals")
    if not in_space and chosen.objective != "wrench" and proof.tied is not None:
        broken.append(f"the proof is of forces tied by stiffness, not of {chosen.objective}")
    if in_space and chosen.objective in _LEVELS:
        broken.append(f"objective {chosen.objective!r} has no bound on meshes")
    elif wrong := _check_proof(proof):
        broken += wrong
    else:
        broken += _check_bound(chosen, proof)
        share = share_on(chosen.shape, proof) if in_space else 0.0
        broken += _check_spots(chosen, cast(Any, proof), share) if in_space else _check_places(chosen, proof)
    broken += [] if in_space else others_limits(chosen, proof, chosen.objective in _LEVELS)
    asked = "" if broken else part_of_surface(share) if in_space else _part(proof, chosen.shape)
    return Verification(
        tuple(broken), max(residuals), min(angles), min(slacks), excluded=_leaves(proof), bound=chosen.bound,
        asked=asked,
    )  # fmt: skip


def verify_proof(proof: Proof) -> Verification:
    """The verdict on a proof alone."""
    broken = _check_proof(proof)
    part = "" if broken or hasattr(proof, "normals") else _part(proof)
    return Verification(tuple(broken), 0.0, inf, inf, excluded=_leaves(proof), bound=proof.bound, asked=part)


def _check_proof(proof: Any) -> list[str]:
    try:
        return check_surface_proof(proof) if hasattr(proof, "normals") else check_proof(proof)
    except OverflowError as error:
        return [f"proof: its numbers are none to compute with: {error}"]


def _leaves(proof: Any) -> int:
    """How many boxes are not split."""
    return int((np.asarray(proof.children)[:, 1] == 0).sum())


def _is_without_margin(chosen: Chosen, proof: Any) -> bool:
    """Whether a proof is that no forces below the limit are inside the cones, margin or none."""
    return chosen.objective == "force" and (proof.size, proof.norm) == ("force", "largest")


def _part(proof: Proof, shape: Any = None) -> str:
    """Which part of the outline the places are on that a proof is about; empty for all of it."""
    share = Touching(proof).share
    tied = "" if proof.tied is None else " of fingers that answer by equal stiffness"
    if proof.rings is None and len(getattr(shape, "hole_polygons", tuple)()):
        tied += " outside of holes"
    return tied if share > 1 - _CLOSE else f"{tied} on the {share:.1%} of the outline that was asked about"


def _check_spots(chosen: Chosen, proof: SurfaceProof, share: float) -> list[str]:
    """That the contacts are fingers that the proof is about, which has a share of the mesh given."""
    shape: Any = chosen.shape
    if share < 0:
        return ["the proof is about another mesh"]
    if len(chosen.grasp) != proof.fingers:
        return [f"the proof is about {proof.fingers} fingers, the grasp has {len(chosen.grasp)}"]
    broken = []
    for contact in chosen.grasp:
        if not touches(proof, contact):
            broken.append(f"contact {contact.name} is on none of the faces that the proof is about")
        if contact.friction > proof.friction:
            broken.append(f"contact {contact.name} has more friction than the proof is about")
    positions = chosen.grasp.positions
    if _nearest(positions) < proof.min_distance - float(RESOLUTION) * np.abs(positions).max():
        broken.append("two contacts are nearer than the least distance")
    if not _all_shown(chosen, np.asarray(proof.loads)):
        broken.append("a load of the proof has no state")
    return broken + _off_their_places(chosen, np.asarray(chosen.places) - shape.centre_of_mass)


def _check_value(chosen: Chosen, state: GraspState, i: int) -> list[str]:
    """That a state shows the value."""
    size, norm = _MEANINGS[chosen.objective]
    found, value = _norm(state, size, norm), chosen.value
    limit = inf if chosen.max_force is None else chosen.max_force
    largest = found if chosen.objective == "wrench_ball" else _norm(state, "force", "largest")
    if not largest <= limit * (1 + _CLOSE):
        return [f"state {i}: a force of {largest:.12g} is above the limit {limit:.12g}"]
    if not ((state.forces * state.grasp.normals).sum(axis=1) >= chosen.min_normal * (1 - _CLOSE)).all():
        return [f"state {i}: a finger pushes with less than {chosen.min_normal:.12g}"]
    if chosen.objective not in _LEVELS:
        if found ** _power(norm) > value * (1 + _CLOSE):
            return [f"state {i}: {chosen.objective} is above the value {value:.12g}"]
        return []
    broken = []
    if chosen.objective == "angle" and state.margins.least_angle < value - _CLOSE:
        broken.append(f"state {i}: the angle margin is below the value {value:.12g}")
    if chosen.objective == "force" and state.margins.least_force < value * (1 - _CLOSE):
        broken.append(f"state {i}: the force margin is below the value {value:.12g}")
    if chosen.objective == "friction_use" and state.margins.largest_friction_use > value + _CLOSE:
        broken.append(f"state {i}: the use of friction is above the value {value:.12g}")
    return broken


def _check_bound(chosen: Chosen, proof: Proof) -> list[str]:
    """That the bound is what the proof proves."""
    power = _power(_MEANINGS[chosen.objective][1])
    value, bound = chosen.value, chosen.bound
    largest = chosen.objective in _LARGEST
    if not (bound >= value if largest else bound <= value):
        return [f"bound {bound:.12g} is {'below' if largest else 'above'} the value {value:.12g}"]
    if not isfinite(value) or not isfinite(bound):
        return ["value and bound must be finite numbers"]
    if chosen.objective not in _LEVELS:
        least = max(proof.bound, 0.0)
        said, words = Fraction(least) ** power, f"{min(least, 1e150) ** power:.12g}"
        if said > Fraction(value * (1 + _CLOSE)):
            return [f"value {value:.12g} is below what the proof says, {words}"]
        if not Fraction(bound) <= said * (1 + RESOLUTION):
            return [f"bound {bound:.12g} is above what the proof says, {words}"]
        return []
    if chosen.max_force is None or not 0 < chosen.max_force < inf:
        return ["a level needs the limit of its forces"]
    if chosen.objective in ("answered", "wrench") and chosen.states and (broken := _check_answers(chosen)):
        return broken
    if chosen.objective == "wrench_ball" and (broken := _check_ball(chosen, chosen.max_force)):
        return broken
    beyond = proof.bound >= chosen.max_force if proof.margin else proof.bound > chosen.max_force
    if not beyond:  # forces of the limit itself are allowed; a search cut short proves what needs no proof
        return _check_trivial(chosen, proof, chosen.max_force)
    mu = min(c.friction for c in chosen.grasp)
    if chosen.objective not in _ANY_LOAD and mu != max(c.friction for c in chosen.grasp):
        return ["a level of friction is that of one coefficient, the contacts have several"]
    if chosen.objective == "friction_use":
        proven = Fraction(bound) * Fraction(mu) <= Fraction(proof.friction) * (1 + RESOLUTION)
    elif chosen.objective == "angle":
        proven = bound >= (atan(mu) - atan(proof.friction)) * (1 - _CLOSE)
    elif chosen.objective == "force":
        proven = bound >= proof.margin
    elif chosen.objective in ("answered", "wrench"):  # what is withstood is answered, too
        proven = _scaled_by_less(chosen, np.asarray(proof.loads), bound)
    else:  # no placement holds all loads of the proof, which are members of the ball
        sizes = np.linalg.norm(np.asarray(proof.loads) / [1.0, 1.0, chosen.length or 0.0], axis=1)
        proven = bool((sizes <= bound * (1 + _CLOSE)).all())
    return [] if proven else [f"bound {bound:.12g} is better than what the proof says"]


def _check_others(chosen: Chosen) -> list[str]:
    """That no grasp that was passed over is better than the bound."""
    sign = -1 if chosen.objective in _LARGEST else 1
    slack = _CLOSE * abs(chosen.bound)
    better = [other.value for other in chosen.others if not sign * (other.value - chosen.bound) >= -slack]
    return [f"a grasp passed over has the value {better[0]:.12g}, better than the bound"] if better else []


def _off_their_places(chosen: Chosen, given: Array) -> list[str]:
    """That the contacts are at the places that are said, whose points are ``given`` [m]."""
    positions = chosen.grasp.positions
    if given.shape != positions.shape:
        return ["each contact needs a place"]
    off = np.abs(given - positions).max()
    return [] if off <= _CLOSE * np.abs(positions).max() else [f"a contact is {off:.3g} off its place"]


def _check_answers(chosen: Chosen) -> list[str]:
    """That states hold the load and then the deviations times the value; as equal springs, of ``wrench``."""
    first, *others = chosen.states
    shown = np.array([state.load.vector for state in others])
    center = np.asarray(chosen.certificate.loads)[0]
    off = np.abs(first.load.vector - center).max()
    if not _scaled(chosen, shown, chosen.value) or off > _CLOSE * np.abs(shown).max():
        return ["the states do not hold the load, and the deviations times the value on top of it"]
    if chosen.objective == "wrench" and not answer_alike(chosen.states):
        return ["the states are not what fingers of equal stiffness make of the first"]
    return []


def _check_ball(chosen: Chosen, limit: float) -> list[str]:
    """That the fingers make every wrench of the ball."""
    length = chosen.length
    if length is None or not 0 < length < inf:
        return ["a ball of loads needs a length that torques are divided by"]
    if chosen.value < 0 or not makes_ball(chosen.grasp, limit, length, Fraction(chosen.value)):
        return [f"wrench_ball: the fingers do not make all wrenches up to the value {chosen.value:.12g}"]
    return []


def _check_trivial(chosen: Chosen, proof: Proof, limit: float) -> list[str]:
    """A bound that needs no proof: friction is used by 0 or more, margins are at most the half-angle."""
    mu = max(c.friction for c in chosen.grasp)
    if chosen.objective == "friction_use":
        proven = chosen.bound <= 0
    elif chosen.objective == "angle":
        proven = chosen.bound >= atan(mu)
    elif chosen.objective == "force":
        proven = chosen.bound >= limit * sin(atan(mu)) * (1 - _CLOSE)
    elif chosen.objective == "wrench_ball":
        proven = chosen.bound >= len(chosen.grasp) * limit * hypot(1.0, mu)
    else:  # k forces make no larger wrench than k times the limit, at the largest lever
        levers = np.array([1.0, 1.0, Touching(proof).reach])
        most = len(chosen.grasp) * limit * levers
        center, deviations = np.asarray(proof.loads)[0], np.asarray(chosen.deviations)
        proven = bool((np.abs(center + deviations * chosen.bound) >= most).any())
    return [] if proven else ["the proof proves no bound"]


def _scaled(chosen: Chosen, loads: Array, factor: float) -> bool:
    """Whether loads are the first load of the proof with the deviations on top, by a factor."""
    center, deviations = np.asarray(chosen.certificate.loads)[0], np.asarray(chosen.deviations)
    if loads.shape != deviations.shape:
        return False
    wanted = center + deviations * factor
    return bool((np.abs(loads - wanted) <= _CLOSE * np.abs(wanted).max()).all())


def _scaled_by_less(chosen: Chosen, loads: Array, factor: float) -> bool:
    """Whether loads after the first are it with the deviations by no more than a factor on top.

    What does not hold these does not hold them by more either: the first load is between.
    """
    deviations = np.asarray(chosen.deviations)
    if loads[1:].shape != deviations.shape or not deviations.any():
        return False
    own = float(((loads[1:] - loads[0]) * deviations).sum() / (deviations**2).sum())
    return own <= factor * (1 + _CLOSE) and _scaled(chosen, loads[1:], own)


def _power(norm: str) -> int:
    """Values of squares are their sum, not its root."""
    return 2 if norm == "squares" else 1


def _norm(state: GraspState, size: str, norm: str) -> float:
    forces = state.forces
    sizes = (forces * state.grasp.normals).sum(axis=1) if size == "normal" else np.linalg.norm(forces, axis=1)
    return float({"sum": sizes.sum(), "largest": sizes.max(), "squares": np.sqrt((sizes**2).sum())}[norm])


def _check_places(chosen: Chosen, proof: Proof) -> list[str]:
    """That the contacts are fingers that the proof is about, on the shape given."""
    if not hasattr(chosen.shape, "cubics"):
        return ["the proof is about an outline"]
    control = chosen.shape.cubics()
    if (control is None) != (proof.control is None):
        return ["the proof is about another kind of outline"]
    edges, given = (proof.vertices, chosen.shape.polygon()) if control is None else (proof.control, control)
    if proof.rings is not None:
        rings = [given, *(hole[::-1] for hole in chosen.shape.hole_polygons())]
        if np.asarray(proof.rings).tolist() != np.cumsum([0, *map(len, rings[:-1])]).tolist():
            return ["the proof is about another outline"]
        given = np.concatenate(rings)
    if not np.array_equal(np.asarray(edges) - proof.centre_of_mass, given):
        return ["the proof is about another outline"]
    if len(chosen.grasp) != proof.fingers:
        return [f"the proof is about {proof.fingers} fingers, the grasp has {len(chosen.grasp)}"]
    broken = []
    touching = Touching(proof)
    slack = float(RESOLUTION) * touching.reach
    for contact in chosen.grasp:
        if contact not in touching:
            broken.append(f"contact {contact.name} is on none of the sides that the proof is about")
        if chosen.objective not in ("friction_use", "angle") and contact.friction > proof.friction:
            broken.append(f"contact {contact.name} has more friction than the proof is about")
    if _nearest(chosen.grasp.positions) < proof.min_distance - slack:
        broken.append("two contacts are nearer than the least distance")
    if chosen.objective not in _ANY_LOAD and not _all_shown(chosen, np.asarray(proof.loads)):
        broken.append("a load of the proof has no state")
    return broken + _off_their_places(chosen, points_at(chosen.places, given, control, proof.rings))


def _nearest(positions: Array) -> float:
    away = np.linalg.norm(positions[:, None] - positions, axis=2)
    return float(away[np.triu_indices(len(positions), 1)].min(initial=inf))


def _all_shown(chosen: Chosen, loads: Array) -> bool:
    """Whether states hold all loads: each is that of a state, or lies between those of two."""
    shown = np.array([state.load.vector for state in chosen.states]).reshape(-1, loads.shape[1])
    size = np.abs(loads).max(axis=0)
    scale = np.where(size > 0, size, size.max() or 1.0)  # forces and torques have units of their own
    shown, loads = shown / scale, loads / scale
    sides = shown[None] - shown[:, None]
    squares = np.maximum((sides**2).sum(axis=2), np.finfo(float).tiny)
    for load in loads:
        away = load - shown
        share = np.clip((away[:, None] * sides).sum(axis=2) / squares, 0.0, 1.0)
        off = np.abs(away[:, None] - share[..., None] * sides).max(axis=2)
        if not off.min(initial=inf) <= _CLOSE:
            return False
    return True
