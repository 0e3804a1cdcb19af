"""Whether the bound of a level is what a proof proves, at which no forces below a limit exist."""

from fractions import Fraction
from math import atan, hypot, inf, isfinite, sin
from typing import Any

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.claims.meanings import ANY_LOAD, CLOSE
from regrasp.verification.placed.protocol import Chosen, Proof
from regrasp.verification.placed.touching import Touching
from regrasp.verification.placed.whole_sets import answer_alike, makes_ball


def check_level(chosen: Chosen, proof: Proof) -> list[str]:
    """That no placement is beyond the bound, which is no worse than the value."""
    bound = chosen.bound
    if chosen.max_force is None or not 0 < chosen.max_force < inf:
        return ["a level needs the limit of its forces"]
    if chosen.objective in ("answered", "wrench") and chosen.states and (broken := check_answers(chosen)):
        return broken
    if chosen.objective == "wrench_ball" and (broken := check_ball(chosen, chosen.max_force)):
        return broken
    beyond = (
        proof.bound >= chosen.max_force if getattr(proof, "margin", 0.0) else proof.bound > chosen.max_force
    )
    if not beyond:  # forces of the limit itself are allowed; a search cut short proves what needs no proof
        return check_trivial(chosen, proof, chosen.max_force)
    mu = min(c.friction for c in chosen.grasp)
    if chosen.objective not in ANY_LOAD and mu != max(c.friction for c in chosen.grasp):
        return ["a level of friction is that of one coefficient, the contacts have several"]
    if chosen.objective == "friction_use":
        proven = Fraction(bound) * Fraction(mu) <= Fraction(proof.friction) * (1 + RESOLUTION)
    elif chosen.objective == "angle":
        proven = bound >= (atan(mu) - atan(proof.friction)) * (1 - CLOSE)
    elif chosen.objective == "force":
        proven = bound >= proof.margin
    elif chosen.objective in ("answered", "wrench"):  # what is withstood is answered, too
        proven = _scaled_by_less(chosen, np.asarray(proof.loads), bound)
    else:  # no placement holds all loads of the proof, which are members of the ball
        sizes = np.linalg.norm(np.asarray(proof.loads) / [1.0, 1.0, chosen.length or 0.0], axis=1)
        proven = bool((sizes <= bound * (1 + CLOSE)).all())
    return [] if proven else [f"bound {bound:.12g} is better than what the proof says"]


def check_answers(chosen: Chosen) -> list[str]:
    """That states hold the load and then the deviations times the value; as equal springs, of ``wrench``."""
    if chosen.value < 0:
        return [f"deviations are answered by 0 times or more, not by {chosen.value:.12g}"]
    first, *others = chosen.states
    shown = np.array([state.load.vector for state in others])
    center = np.asarray(chosen.certificate.loads)[0]
    off = np.abs(first.load.vector - center)
    if not _scaled(chosen, shown, chosen.value) or (off > CLOSE * _sizes(center, shown)).any():
        return ["the states do not hold the load, and the deviations times the value on top of it"]
    if chosen.objective == "wrench" and not answer_alike(chosen.states):
        return ["the states are not what fingers of equal stiffness make of the first"]
    return []


def check_ball(chosen: Chosen, limit: float) -> list[str]:
    """That the fingers make every wrench of the ball."""
    length = chosen.length
    if length is None or not 0 < length < inf:
        return ["a ball of loads needs a length that torques are divided by"]
    if chosen.value < 0 or not makes_ball(chosen.grasp, limit, length, Fraction(chosen.value)):
        return [f"wrench_ball: the fingers do not make all wrenches up to the value {chosen.value:.12g}"]
    return []


def check_whole_ball(chosen: Chosen) -> list[str]:
    """That the fingers make no larger ball, but for rounding: a billionth of it and of the largest wrench."""
    limit, length = chosen.max_force, chosen.length
    if limit is None or length is None or not 0 < min(limit, length) <= max(limit, length) < inf:
        return []  # which is wrong anyway
    lever = float(np.linalg.norm(chosen.grasp.positions, axis=1).max()) / length
    mu = max(c.friction for c in chosen.grasp)
    most = len(chosen.grasp) * limit * hypot(1.0, mu) * max(1.0, lever)
    if not (isfinite(chosen.value) and most < inf):
        return []
    larger = Fraction(chosen.value) + Fraction(CLOSE) * (Fraction(chosen.value) + Fraction(most))
    if makes_ball(chosen.grasp, limit, length, max(larger, Fraction(0))):
        return [f"value {chosen.value:.12g} is worse than the ball of wrenches that the fingers make"]
    return []


def check_trivial(chosen: Chosen, proof: Proof, limit: float) -> list[str]:
    """A bound that needs no proof: friction is used by 0 or more, margins are at most the half-angle."""
    mu = max(c.friction for c in chosen.grasp)
    if chosen.objective == "friction_use":
        proven = chosen.bound <= 0
    elif chosen.objective == "angle":
        proven = chosen.bound >= atan(mu)
    elif chosen.objective == "force":
        proven = chosen.bound >= limit * sin(atan(mu)) * (1 - CLOSE)
    elif chosen.objective == "wrench_ball":
        proven = chosen.bound >= len(chosen.grasp) * limit * hypot(1.0, mu)
    else:  # k forces make no larger wrench than k times the limit, at the largest lever
        levers = _levers(proof)
        most = len(chosen.grasp) * limit * levers
        center, deviations = np.asarray(proof.loads)[0], np.asarray(chosen.deviations)
        proven = bool((np.abs(center + deviations * chosen.bound) >= most).any())
    return [] if proven else ["the proof proves no bound"]


def _levers(proof: Any) -> Array:
    """The largest wrench that a force of size 1 makes, of each component."""
    if hasattr(proof, "normals"):
        return np.repeat([1.0, float(np.linalg.norm(proof.corners, axis=2).max())], 3)
    return np.array([1.0, 1.0, Touching(proof).reach])


def _scaled(chosen: Chosen, loads: Array, factor: float) -> bool:
    """Whether loads are the first load of the proof with the deviations on top, by a factor."""
    center, deviations = np.asarray(chosen.certificate.loads)[0], np.asarray(chosen.deviations)
    if loads.shape != deviations.shape:
        return False
    wanted = center + deviations * factor
    return bool((np.abs(loads - wanted) <= CLOSE * _sizes(center, wanted)).all())


def _sizes(center: Array, loads: Array) -> Array:
    """The largest force in the place of each force and the largest torque in that of each torque."""
    most = np.abs([center, *loads]).max(axis=0)
    d = 2 if len(most) == 3 else 3
    return np.repeat([most[:d].max(), most[d:].max()], [d, len(most) - d])


def _scaled_by_less(chosen: Chosen, loads: Array, factor: float) -> bool:
    """Whether loads after the first are it with the deviations by 0 times or more, to a factor, on top.

    What does not hold these does not hold them by more either: they are between these and the first load.
    """
    deviations = np.asarray(chosen.deviations)
    if loads[1:].shape != deviations.shape or not deviations.any():
        return False
    own = float(((loads[1:] - loads[0]) * deviations).sum() / (deviations**2).sum())
    return 0 <= own <= factor * (1 + CLOSE) and _scaled(chosen, loads[1:], own)
