"""The verdict on a grasp chosen from a shape: its states, where it touches, and the proof of its bound."""

from fractions import Fraction
from math import inf
from typing import Protocol

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.state import GraspState
from regrasp.verification.exact import RESOLUTION, check_state, least_angle
from regrasp.verification.placements import Proof, check_proof
from regrasp.verification.verdict import Verification


class Shape(Protocol):
    """An outline as ``verify`` sees it."""

    def polygon(self) -> Array:
        """(k, 2) vertices relative to the centre of mass [m]."""


class Chosen(Protocol):
    """What ``verify`` needs to know of a chosen grasp, whoever chose it."""

    shape: Shape
    objective: str
    grasp: Grasp
    states: tuple[GraspState, ...]
    value: float
    bound: float
    certificate: Proof


# objective: size of a force, norm of the sizes, power of the norm
_MEANINGS = {
    "sum_normal": ("normal", "sum", 1),
    "peak_normal": ("normal", "largest", 1),
    "peak": ("force", "largest", 1),
    "effort": ("force", "squares", 2),
}
_CLOSE = 1e-9  # of a value, the same in another order of the sums


def verify_chosen(chosen: Chosen) -> Verification:
    """The verdict on a chosen grasp, proof included."""
    broken: list[str] = []
    residuals, slacks, angles = [0.0], [inf], [inf]
    proof = chosen.certificate
    if chosen.objective not in _MEANINGS:
        return Verification((f"objective {chosen.objective!r} has no bound",), inf, 0.0, -inf)
    size, norm, power = _MEANINGS[chosen.objective]
    if (proof.size, proof.norm) != (size, norm):
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
        if _norm(state, size, norm) ** power > chosen.value * (1 + _CLOSE):
            broken.append(f"state {i}: {chosen.objective} is above the value {chosen.value:.12g}")
    if not chosen.states:
        broken.append("no state shows the value")
    if not chosen.bound <= chosen.value:
        broken.append(f"bound {chosen.bound:.12g} is above the value {chosen.value:.12g}")
    if not Fraction(chosen.bound) <= Fraction(proof.bound) ** power * (1 + RESOLUTION):
        broken.append(f"bound {chosen.bound:.12g} is above what the proof says, {proof.bound**power:.12g}")
    broken += check_proof(proof) or _check_places(chosen, proof)
    boxes = int((np.asarray(proof.children)[:, 1] == 0).sum())
    return Verification(
        tuple(broken), max(residuals), min(angles), min(slacks), excluded=boxes, bound=chosen.bound
    )


def verify_proof(proof: Proof) -> Verification:
    """The verdict on a proof alone."""
    boxes = int((np.asarray(proof.children)[:, 1] == 0).sum())
    return Verification(tuple(check_proof(proof)), 0.0, inf, inf, excluded=boxes, bound=proof.bound)


def _norm(state: GraspState, size: str, norm: str) -> float:
    forces = state.forces
    sizes = (forces * state.grasp.normals).sum(axis=1) if size == "normal" else np.hypot(*forces.T)
    return float({"sum": sizes.sum(), "largest": sizes.max(), "squares": np.sqrt((sizes**2).sum())}[norm])


def _check_places(chosen: Chosen, proof: Proof) -> list[str]:
    """That the contacts are fingers that the proof is about, on the shape given."""
    vertices = np.asarray(proof.vertices) - proof.centre_of_mass
    if not np.array_equal(vertices, chosen.shape.polygon()):
        return ["the proof is about another outline"]
    if len(chosen.grasp) != proof.fingers:
        return [f"the proof is about {proof.fingers} fingers, the grasp has {len(chosen.grasp)}"]
    broken = []
    scale = float(np.hypot(*vertices.T).max())
    slack = float(RESOLUTION) * scale
    along = np.roll(vertices, -1, axis=0) - vertices
    edges = proof.sides[:, 0].astype(int)
    start = vertices[edges] + (proof.sides[:, 1] - edges)[:, None] * along[edges]
    stop = vertices[edges] + (proof.sides[:, 2] - edges)[:, None] * along[edges]
    unit = along[edges] / np.hypot(*along[edges].T)[:, None]
    for contact in chosen.grasp:
        away = contact.position - start
        feet = np.clip((away * unit).sum(axis=1), 0.0, np.hypot(*(stop - start).T))
        distance = np.hypot(*(away - feet[:, None] * unit).T)
        turned = np.hypot(contact.normal[0] + unit[:, 1], contact.normal[1] - unit[:, 0])
        if not ((distance <= slack) & (turned <= 4 * float(RESOLUTION))).any():
            broken.append(f"contact {contact.name} is on none of the sides that the proof is about")
        if contact.friction > proof.friction:
            broken.append(f"contact {contact.name} has more friction than the proof is about")
    positions = chosen.grasp.positions
    for i in range(len(positions)):
        for j in range(i):
            if np.hypot(*(positions[i] - positions[j])) < proof.min_distance - slack:
                broken.append("two contacts are nearer than the least distance")
    asked = {tuple(load) for load in np.asarray(proof.loads).tolist()}
    shown = {tuple(state.load.vector.tolist()) for state in chosen.states}
    if len(chosen.states) > 1 and not asked <= shown:
        broken.append("a load of the proof has no state")
    return broken
