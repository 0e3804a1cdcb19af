"""Whether contacts are fingers that a proof is about, on the shape given, and states hold all its loads."""

from collections.abc import Callable
from math import inf
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.contact import Contact
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.arc_lengths import points_at
from regrasp.verification.placed.claims.meanings import ANY_LOAD, CLOSE
from regrasp.verification.placed.meshes.surfaces import SurfaceProof, touches
from regrasp.verification.placed.protocol import Chosen, Proof
from regrasp.verification.placed.touching import Touching

_AT_ONCE = 1 << 16  # pairs of states
_NEIGHBOURS = 12


def check_spots(chosen: Chosen, proof: SurfaceProof, share: float) -> list[str]:
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
        if chosen.objective not in ("friction_use", "angle") and contact.friction > proof.friction:
            broken.append(f"contact {contact.name} has more friction than the proof is about")
    positions = chosen.grasp.positions
    apart = proof.min_distance - float(RESOLUTION) * np.abs(positions).max()
    if _nearest(positions) < apart:
        broken.append("two contacts are nearer than the least distance")
    if chosen.objective not in ANY_LOAD and not _all_shown(chosen, np.asarray(proof.loads)):
        broken.append("a load of the proof has no state")
    broken += _off_their_places(chosen, np.asarray(chosen.places) - shape.centre_of_mass)
    return broken or _others_wrong(
        chosen, apart, lambda c: touches(proof, c), lambda places: np.asarray(places) - shape.centre_of_mass
    )


def check_places(chosen: Chosen, proof: Proof) -> list[str]:
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
    apart = proof.min_distance - float(RESOLUTION) * touching.reach
    for contact in chosen.grasp:
        if contact not in touching:
            broken.append(f"contact {contact.name} is on none of the sides that the proof is about")
        if chosen.objective not in ("friction_use", "angle") and contact.friction > proof.friction:
            broken.append(f"contact {contact.name} has more friction than the proof is about")
    if _nearest(chosen.grasp.positions) < apart:
        broken.append("two contacts are nearer than the least distance")
    if chosen.objective not in ANY_LOAD and not _all_shown(chosen, np.asarray(proof.loads)):
        broken.append("a load of the proof has no state")
    if proof.turned and not _all_turns_shown(chosen, np.asarray(proof.loads)):
        broken.append("a load that a turn makes of one of the proof has no state")

    def points(places: Array) -> Array:
        return points_at(places, given, control, proof.rings)

    broken += _off_their_places(chosen, points(chosen.places))
    return broken or _others_wrong(chosen, apart, touching.__contains__, points)


def _others_wrong(
    chosen: Chosen, apart: float, is_on: Callable[[Contact], bool], points: Callable[[Array], Array]
) -> list[str]:
    """That grasps that were passed over are of such fingers, too; what they are worth no state shows."""
    frictions = set(chosen.grasp.frictions.tolist())
    for number, other in enumerate(chosen.others, 1):
        grasp = other.grasp
        if grasp.positions.shape != chosen.grasp.positions.shape or not all(map(is_on, grasp)):
            wrong = "not of fingers where the proof has them"
        elif not set(grasp.frictions.tolist()) <= frictions:
            wrong = "of another friction"
        elif _nearest(grasp.positions) < apart:
            wrong = "two contacts are nearer than the least distance"
        elif off := _off_their_places(other, points(other.places)):
            wrong = off[0]
        else:
            continue
        return [f"grasp {number} of those passed over: {wrong}"]
    return []


def _all_turns_shown(chosen: Chosen, loads: Array) -> bool:
    """Whether the hull of the states' loads has all that turns make of some."""
    shown = np.array([state.load.vector for state in chosen.states]).reshape(-1, 3)
    torques = np.concatenate([shown[:, 2], loads[:, 2]])
    shown = shown[np.argsort(np.arctan2(shown[:, 1], shown[:, 0])), :2]
    after, size = np.roll(shown, -1, axis=0), np.hypot(loads[:, 0], loads[:, 1]).max()
    across = shown[:, 0] * after[:, 1] - shown[:, 1] * after[:, 0]
    around = (across > 0) & (across >= size * (1 - CLOSE) * np.hypot(*(after - shown).T))
    return bool(len(shown) > 2 and around.all() and np.ptp(torques) <= CLOSE * np.abs(torques).max())


def _off_their_places(chosen: Any, given: Array) -> list[str]:
    """That the contacts are at the places that are said, whose points are ``given`` [m]."""
    positions = chosen.grasp.positions
    if given.shape != positions.shape:
        return ["each contact needs a place"]
    off = np.abs(given - positions).max()
    return [] if off <= CLOSE * np.abs(positions).max() else [f"a contact is {off:.3g} off its place"]


def _nearest(positions: Array) -> float:
    away = np.linalg.norm(positions[:, None] - positions, axis=2)
    return float(away[np.triu_indices(len(positions), 1)].min(initial=inf))


def _all_shown(chosen: Chosen, loads: Array) -> bool:
    """Whether states hold all loads: each is that of a state, or lies between those of two.

    Its last component may also be between what two such mixtures have.
    """
    shown = np.array([state.load.vector for state in chosen.states]).reshape(-1, loads.shape[1])
    scale = np.ones(loads.shape[1])
    for one in (slice(2), slice(2, 3)) if len(scale) == 3 else (slice(3), slice(3, 6)):
        size = np.abs(loads[:, one]).max(axis=0)  # forces and torques have units of their own
        scale[one] = np.where(size > 0, size, size.max() or np.abs(shown[:, one]).max(initial=0.0) or 1.0)
    shown, loads = shown / scale, loads / scale
    return all(_is_between(load, _nearest_of(shown, load)) or _is_between(load, shown) for load in loads)


def _nearest_of(shown: Array, load: Array) -> Array:
    """Some states' loads: of a thousand around, a load is between neighbours, and all pairs take a minute."""
    away = np.abs(shown - load)[:, :-1].max(axis=1)
    result: Array = shown[np.argsort(away, kind="stable")[:_NEIGHBOURS]]
    return result


def _is_between(load: Array, shown: Array) -> bool:
    away = load - shown
    if (np.abs(away) <= CLOSE).all(axis=1).any():  # that of a state
        return True
    least, most = inf, -inf
    some = max(_AT_ONCE // max(len(shown), 1), 1)
    for first in range(0, len(shown), some):
        here = slice(first, first + some)
        sides = shown[None] - shown[here, None]
        squares = np.maximum((sides[..., :-1] ** 2).sum(axis=2), np.finfo(float).tiny)
        share = np.clip((away[here, None, :-1] * sides[..., :-1]).sum(axis=2) / squares, 0.0, 1.0)
        left = away[here, None] - share[..., None] * sides
        last = left[..., -1][(np.abs(left[..., :-1]) <= CLOSE).all(axis=2)]
        least, most = min(least, last.min(initial=inf)), max(most, last.max(initial=-inf))
        if least <= CLOSE and most >= -CLOSE:
            return True
    return False
