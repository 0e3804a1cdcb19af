"""A motion that the contacts hardly oppose, changed by a hair so that they do not at all.

A solver's twist touches the cones to its tolerance, 1e-8 or so, and a finger without a force limit could
oppose that much enough. Newton's method on

    n_i . u_i - mu_i |u_i across n_i| = delta      where contact i slides (u_i, its velocity, is not zero),
    u_i = 0                                        where it stands still,

for the contacts that oppose the motion, in rational arithmetic, places it beyond the last bit of doubles;
delta, a few units of rounding, is what the rounding of the twist itself may take away. Contacts that stand
still have no such delta: there a motion that clears all of them, where one is given, is added by a hair.
"""

from collections.abc import Iterator
from fractions import Fraction
from math import hypot, inf, sqrt

import numpy as np

from regrasp.mechanics.checks import Array
from regrasp.mechanics.escape import NEVER, EscapeTwist
from regrasp.mechanics.grasp import Grasp
from regrasp.mechanics.opposition import dot, exact
from regrasp.mechanics.wrench import Wrench

# Contacts that move by less than these fractions of the motion's speed may be meant to stand still.
_STILL = (1e-12, 1e-6, 1e-3)
# A contact that opposes a motion by less than this fraction of its speed is meant not to oppose it at all.
_TOUCHING = 1e-3
_STEPS = 8
_REACHED = 2.0**-60
_ROUNDING = 2.0**-50
# A contact without limit that opposes a motion by more than this part of its speed holds by a small lever:
# then forces must be so many times what counts as never.
_FAR = 10
_NOISE = 2.0**-46
# Lengths of the twist at which its rounding is tried where contacts that stand still leave no other room.
_LENGTHS = 24
# The hair: what contacts are cleared by, as a part of the motion's speed.
_HAIR = 2.0**-46


def proven(
    grasp: Grasp,
    load: Wrench,
    twist: Array,
    frictions: list[float],
    limits: list[float],
    clear: Array | None = None,
) -> EscapeTwist | None:
    """The twist, or one a hair from it, along ``clear`` if given, as a proof; None where none is found."""
    never = NEVER * (hypot(*load.force) + hypot(*load.torque) / (grasp.size or 1.0))
    for candidate in _candidates(grasp, twist, frictions, limits):
        if clear is not None:
            candidate = candidate + clear * (_HAIR * float(abs(candidate * grasp.lengths).max()))
        if candidate.any() and np.isfinite(candidate).all():
            found = EscapeTwist(grasp, load, candidate, tuple(frictions), tuple(limits))
            speed = float(abs(candidate * grasp.lengths).max())
            opposed = max(
                (o for o, f in zip(found.oppositions, limits, strict=True) if f == inf), default=0.0
            )
            if found.is_proof and (opposed <= _NOISE * speed or found.least_force > _FAR * never):
                return found
            if found.load_power <= 0:
                return None
    return None


def _candidates(grasp: Grasp, twist: Array, frictions: list[float], limits: list[float]) -> Iterator[Array]:
    tried = set()
    for still in _STILL:
        for delta in (2 * _ROUNDING, 0.0):  # no room for it where other contacts stand still
            refined, rests = _refined(grasp, twist, frictions, limits, still, delta)
            largest = max(abs(x) for x in refined)
            if not largest or (delta, rests) in tried:
                continue
            tried.add((delta, rests))
            lengths = [1 / largest]
            if rests and delta == 0:
                # Per radian about an axis the velocity is a product with coordinates, often an exact one.
                lengths = [1 / abs(x) for x in refined[grasp.dimension :] if abs(x) > largest / 2**20]
                lengths += [Fraction(_LENGTHS + k, _LENGTHS) / largest for k in range(_LENGTHS)]
            for length in lengths:
                yield np.array([float(x * length) for x in refined])


def _refined(
    grasp: Grasp, twist: Array, frictions: list[float], limits: list[float], still: float, delta: float
) -> tuple[list[Fraction], frozenset[int]]:
    """The twist after Newton's steps, and the contacts that stand still in it."""
    w, size = grasp.width, twist.size
    weight = 1 / grasp.lengths
    arms = grasp.cones.matrix.T * weight  # velocities of the contacts from the twist in speeds at ``size``
    columns = [exact(column) for column in grasp.cones.matrix.T]
    v = exact(twist / float(abs(twist * grasp.lengths).max()))
    free = {i: exact(grasp.cones.normals[i]) for i, limit in enumerate(limits) if limit == inf}
    rows: dict[int, bool] = {}  # contacts held to their cones: whether they stand still
    for _ in range(_STEPS):
        jacobian, misses = [], []
        speed = max(abs(float(x) * arm) for x, arm in zip(v, grasp.lengths.tolist(), strict=True))
        for i, n in free.items():
            u = [dot(v, column) for column in columns[w * i : w * i + w]]
            normal = dot(u, n) / dot(n, n)
            across = [a - normal * b for a, b in zip(u, n, strict=True)]
            sideways = _root(dot(across, across))
            slack = normal - Fraction(frictions[i]) * sideways
            if slack < Fraction(_ROUNDING * speed) and slack > Fraction(-_TOUCHING * speed):
                rows.setdefault(i, float(_root(dot(u, u))) < still * speed)
            if i not in rows:
                continue
            at = arms[w * i : w * i + w]
            if rows[i]:
                jacobian += list(at)
                misses += [float(x) for x in u]
            else:
                direction = [float(a / sideways) if sideways else 0.0 for a in across]
                jacobian.append(at.T @ (grasp.cones.normals[i] - frictions[i] * np.array(direction)))
                misses.append(float(slack) - delta * speed)
        if not rows or max(map(abs, misses)) <= _REACHED * speed:
            break
        step = np.linalg.lstsq(np.array(jacobian).reshape(-1, size), np.array(misses), rcond=1e-12)[0]
        v = [a - Fraction(b) for a, b in zip(v, (step * weight).tolist(), strict=True)]
    return v, frozenset(i for i, rests in rows.items() if rests)


def _root(square: Fraction) -> Fraction:
    """The square root, to 2^-100 of it."""
    if square == 0:
        return square
    guess = Fraction(sqrt(square)) or Fraction(1, 2**500)
    return (guess + square / guess) / 2
