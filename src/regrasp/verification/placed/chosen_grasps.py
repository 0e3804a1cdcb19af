"""The verdict on a grasp chosen from a shape: its states, where it touches, and the proof of its bound."""

from fractions import Fraction
from math import inf, isfinite
from typing import Any, cast

import numpy as np

from regrasp.mechanics.state import GraspState
from regrasp.verification.exact import RESOLUTION, check_state, least_angle
from regrasp.verification.placed.claims.contacts import check_places, check_spots
from regrasp.verification.placed.claims.levels import check_level, check_whole_ball
from regrasp.verification.placed.claims.meanings import (
    CLOSE,
    LARGEST,
    LEVELS,
    MEANINGS,
    SPACE_LEVELS,
    power_of,
)
from regrasp.verification.placed.forces.limited import others_limits
from regrasp.verification.placed.meshes.areas import part_of_surface, share_on
from regrasp.verification.placed.meshes.surfaces import check_surface_proof
from regrasp.verification.placed.placements import check_proof
from regrasp.verification.placed.protocol import Chosen, Proof
from regrasp.verification.placed.touching import Touching
from regrasp.verification.verdict import Verification

_LITTLE = 1e-5  # of an extent: fingers as near as that count as one


@np.errstate(all="ignore")  # numbers of others may be of any size: what comes of them is judged
def verify_chosen(chosen: Chosen) -> Verification:
    """The verdict on a chosen grasp, proof included."""
    broken: list[str] = []
    residuals, slacks, angles = [0.0], [inf], [inf]
    proof = chosen.certificate
    if chosen.objective not in MEANINGS:
        return Verification((f"objective {chosen.objective!r} has no bound",), inf, 0.0, -inf)
    if soft := [contact.name for contact in chosen.grasp if contact.torsion is not None]:
        words = f"contact {soft[0]} is a soft finger, proofs are about point contacts"
        return Verification((words,), inf, 0.0, -inf)
    if (proof.size, proof.norm) != MEANINGS[chosen.objective] and not _is_without_margin(chosen, proof):
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
    broken += _check_shown(chosen) if chosen.states else ["no state shows the value"]
    broken += _check_others(chosen)
    in_space = hasattr(proof, "normals")
    if not in_space and chosen.objective != "wrench" and proof.tied is not None:
        broken.append(f"the proof is of forces tied by stiffness, not of {chosen.objective}")
    if in_space and chosen.objective in LEVELS and chosen.objective not in SPACE_LEVELS:
        broken.append(f"objective {chosen.objective!r} has no bound on meshes")
    elif wrong := _check_proof(proof):
        broken += wrong
    else:
        broken += _check_bound(chosen, proof)
        share = share_on(chosen.shape, proof) if in_space else 0.0
        broken += check_spots(chosen, cast(Any, proof), share) if in_space else check_places(chosen, proof)
    broken += [] if in_space else others_limits(chosen, proof, chosen.objective in LEVELS)
    asked = "" if broken else part_of_surface(share) if in_space else _part(proof, chosen.shape)
    asked += "" if broken else _apart(proof)
    return Verification(
        tuple(broken), max(residuals), min(angles), min(slacks), excluded=_leaves(proof), bound=chosen.bound,
        asked=asked,
    )  # fmt: skip


@np.errstate(all="ignore")
def verify_proof(proof: Proof) -> Verification:
    """The verdict on a proof alone."""
    broken = _check_proof(proof)
    part = "" if broken or hasattr(proof, "normals") else _part(proof)
    part += "" if broken else _apart(proof)
    return Verification(tuple(broken), 0.0, inf, inf, excluded=_leaves(proof), bound=proof.bound, asked=part)


def _check_proof(proof: Any) -> list[str]:
    try:
        return check_surface_proof(proof) if hasattr(proof, "normals") else check_proof(proof)
    except OverflowError:
        return ["proof: its numbers are none to compute with"]


def _leaves(proof: Any) -> int:
    """How many boxes are not split."""
    return int((np.asarray(proof.children)[:, 1] == 0).sum())


def _is_without_margin(chosen: Chosen, proof: Any) -> bool:
    """Whether a proof is that no forces below the limit are inside the cones, margin or none."""
    return chosen.objective == "force" and (proof.size, proof.norm) == ("force", "largest")


def _part(proof: Proof, shape: Any = None) -> str:
    """Which part of the outline the places are on that a proof is about; empty for all of it.

    All is all but a billionth of it, and no edge left out, however short.
    """
    share = Touching(proof).share
    whole = share > 1 - CLOSE and len(np.unique(proof.sides[:, 0])) == len(proof.vertices)
    tied = "" if proof.tied is None else " of fingers that answer by equal stiffness"
    if proof.rings is None and len(getattr(shape, "hole_polygons", tuple)()):
        tied += " outside of holes"
    return tied if whole else f"{tied} on the {share:.1%} of the outline that was asked about"


def _apart(proof: Any) -> str:
    """How far apart the fingers are that a proof is about, where that is more than not to be one."""
    points = np.reshape(proof.corners, (-1, 3)) if hasattr(proof, "normals") else proof.vertices
    is_little = proof.min_distance <= _LITTLE * np.ptp(points, axis=0).max()
    return "" if is_little else f", fingers {proof.min_distance:.6g} apart or more,"


def _check_value(chosen: Chosen, state: GraspState, i: int) -> list[str]:
    """That a state shows the value."""
    size, norm = MEANINGS[chosen.objective]
    found, value = _norm(state, size, norm), chosen.value
    limit = inf if chosen.max_force is None else chosen.max_force
    largest = found if chosen.objective == "wrench_ball" else _norm(state, "force", "largest")
    if not largest <= limit * (1 + CLOSE):
        return [f"state {i}: a force of {largest:.12g} is above the limit {limit:.12g}"]
    if not ((state.forces * state.grasp.normals).sum(axis=1) >= chosen.min_normal * (1 - CLOSE)).all():
        return [f"state {i}: a finger pushes with less than {chosen.min_normal:.12g}"]
    if chosen.objective not in LEVELS:
        if found ** power_of(norm) > value * (1 + CLOSE):
            return [f"state {i}: {chosen.objective} is above the value {value:.12g}"]
        return []
    broken = []
    if chosen.objective == "angle" and state.margins.least_angle < value - CLOSE:
        broken.append(f"state {i}: the angle margin is below the value {value:.12g}")
    if chosen.objective == "force" and state.margins.least_force < value * (1 - CLOSE):
        broken.append(f"state {i}: the force margin is below the value {value:.12g}")
    if chosen.objective == "friction_use" and state.margins.largest_friction_use > value + CLOSE:
        broken.append(f"state {i}: the use of friction is above the value {value:.12g}")
    return broken


def _check_shown(chosen: Chosen) -> list[str]:
    """That the value is no worse than the worst of the states, either.

    Of what is answered each state tells both sides (``check_level``), of a ball the fingers do.
    """
    size, norm = MEANINGS[chosen.objective]
    margins = [state.margins for state in chosen.states]
    value = chosen.value
    if chosen.objective == "friction_use":  # NaN where no finger presses
        uses = [each.largest_friction_use for each in margins]
        shown = max((use for use in uses if use == use), default=0.0)
        is_worse = value > shown + CLOSE
    elif chosen.objective == "angle":
        shown = min(each.least_angle for each in margins)
        is_worse = value < shown - CLOSE
    elif chosen.objective == "force":
        shown = min(each.least_force for each in margins)
        is_worse = value < shown - CLOSE * abs(shown)
    elif chosen.objective not in LEVELS:
        shown = max(_norm(state, size, norm) for state in chosen.states) ** power_of(norm)
        is_worse = value > shown * (1 + CLOSE)
    else:
        return check_whole_ball(chosen) if chosen.objective == "wrench_ball" else []
    return [f"value {value:.12g} is worse than what the states show, {shown:.12g}"] if is_worse else []


def _check_bound(chosen: Chosen, proof: Proof) -> list[str]:
    """That the bound is what the proof proves."""
    power = power_of(MEANINGS[chosen.objective][1])
    value, bound = chosen.value, chosen.bound
    largest = chosen.objective in LARGEST
    if not (bound >= value if largest else bound <= value):
        return [f"bound {bound:.12g} is {'below' if largest else 'above'} the value {value:.12g}"]
    if not isfinite(value) or not isfinite(bound):
        return ["value and bound must be finite numbers"]
    if chosen.objective not in LEVELS:
        least = max(proof.bound, 0.0)
        said, words = Fraction(least) ** power, f"{min(least, 1e150) ** power:.12g}"
        if said > Fraction(value * (1 + CLOSE)):
            return [f"value {value:.12g} is below what the proof says, {words}"]
        if not Fraction(bound) <= said * (1 + RESOLUTION):
            return [f"bound {bound:.12g} is above what the proof says, {words}"]
        return []
    return check_level(chosen, proof)


def _check_others(chosen: Chosen) -> list[str]:
    """That no grasp that was passed over is better than the bound."""
    sign = -1 if chosen.objective in LARGEST else 1
    slack = CLOSE * abs(chosen.bound)
    better = [other.value for other in chosen.others if not sign * (other.value - chosen.bound) >= -slack]
    return [f"a grasp passed over has the value {better[0]:.12g}, better than the bound"] if better else []


def _norm(state: GraspState, size: str, norm: str) -> float:
    forces = state.forces
    sizes = (forces * state.grasp.normals).sum(axis=1) if size == "normal" else np.linalg.norm(forces, axis=1)
    return float({"sum": sizes.sum(), "largest": sizes.max(), "squares": np.sqrt((sizes**2).sum())}[norm])
