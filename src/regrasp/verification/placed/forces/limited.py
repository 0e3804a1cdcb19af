"""The most that a finger does whose force has limits, from above, in rationals.

In terms of a = n . v and c = |t . v| a force p n + q t does at most a p + c q along v. What is pushed with is
p >= least, friction allows |q| <= mu p, and |f| <= limit. As p grows, with the largest q that goes with it,
a p + c q rises up to one p and falls from there on: so which p is best under a cap, or above the least, is
decided by comparing squares, and roots are rounded to the side that makes the result larger. Both functions
grow with a and c, so upper bounds of these give upper bounds.
"""

from collections.abc import Callable, Sequence
from fractions import Fraction
from math import inf

import numpy as np

from regrasp.mechanics.checks import Array, Flags
from regrasp.verification.placed.protocol import Chosen, Point, Proof
from regrasp.verification.placed.roots import root_above, root_below

_ROUNDING = 1e-13  # of the terms of a sum
_NORMS = ("normal", "sum"), ("normal", "largest"), ("force", "largest"), ("force", "squares")
Parts = Sequence[Sequence[Point]]
"""Of each finger (a, c) at the ends of its sides."""


def most_work(
    a: Fraction, c: Fraction, mu: Fraction, least: Fraction, cap: Fraction | None, limit: Fraction | None
) -> Fraction:
    """The most of a p + c q with p of at most ``cap``; None for no cap, no limit."""
    s = a + mu * c
    if s <= 0:
        return least * a + c * _across(mu, least, limit)
    if limit is None:
        assert cap is not None
        return cap * s
    if c <= mu * a:  # best along v: p = limit a / |v|
        best2, most = limit**2 * a**2 / (a**2 + c**2), limit * root_above(a**2 + c**2)
    else:
        best2, most = limit**2 / (1 + mu**2), limit * s / root_below(1 + mu**2)
    if cap is not None and best2 > cap**2:
        return cap * a + c * _across(mu, cap, limit)
    return least * a + c * _across(mu, least, limit) if best2 < least**2 else most


def most_less_half_square(
    a: Fraction, c: Fraction, mu: Fraction, least: Fraction, limit: Fraction
) -> Fraction:
    """The most of a p + c q - (p^2 + q^2) / 2."""
    s, ahead2, size2 = a + mu * c, Fraction(0), Fraction(0)  # of the nearest force in the cone to v
    if a > 0 and c <= mu * a:
        ahead2, size2 = a**2, a**2 + c**2
    elif s > 0:
        ahead2, size2 = (s / (1 + mu**2)) ** 2, s**2 / (1 + mu**2)
    if size2 > limit**2:
        ahead2 *= limit**2 / size2
    if ahead2 < least**2:
        q = min(c, _across(mu, least, limit))
        return least * a + c * q - (least**2 + q**2) / 2
    return limit * root_above(size2) - limit**2 / 2 if size2 > limit**2 else size2 / 2


def is_excluded(proof: Proof, work: Fraction, parts: Parts) -> bool:
    """Whether a twist along which a load asks for ``work`` shows that no norm is below the proof's bound."""
    bound, mu, least = Fraction(proof.bound), Fraction(proof.friction), Fraction(proof.min_normal)
    limit = None if proof.max_force is None else Fraction(proof.max_force)
    each = bound if limit is None else min(bound, limit)
    # of forces below the bound, each by itself: what they do at most is too little
    size = (None, each) if proof.size == "force" else (bound, limit)
    if work > _sum(parts, lambda a, c: most_work(a, c, mu, least, *size)):
        return True
    if proof.norm == "sum":
        return work - _sum(parts, lambda a, c: most_work(a - 1, c, mu, least, bound, limit)) >= bound
    if proof.norm == "squares":
        done = _sum(parts, lambda a, c: most_less_half_square(a, c, mu, least, each))
        return 2 * (work - done) >= bound**2
    return False


def roughly_excluded(
    proof: Proof, work: Array, room: Array, most: Callable[[Callable[[Array, Array], Array]], Array]
) -> Flags:
    """(b,) the same in doubles, by more than ``room``, which rounding of 1 N may add to a finger's work.

    most: of a function of a and c the largest of each finger (b, k).
    """
    bound, mu, least = proof.bound, proof.friction, proof.min_normal
    limit = inf if proof.max_force is None else proof.max_force
    each = min(bound, limit)
    size = (inf, each) if proof.size == "force" else (bound, limit)
    room = room * proof.fingers * max(each, least) * (1 + mu)

    def clear(least_work: float, done: Array, room: Array) -> Flags:
        return np.asarray(work - done.sum(axis=1) > least_work + room)

    found = clear(0.0, most(lambda a, c: _roughly_most_work(a, c, mu, least, *size)), room)
    if proof.norm == "sum":
        done = most(lambda a, c: _roughly_most_work(a - 1, c, mu, least, bound, limit))
        found |= clear(bound, done, room + _ROUNDING * bound)
    elif proof.norm == "squares":
        done = most(lambda a, c: _roughly_most_less(a, c, mu, least, each))
        found |= clear(0.5 * bound**2, done, room + _ROUNDING * bound**2)
    return found


def _roughly_most_work(a: Array, c: Array, mu: float, least: float, cap: float, limit: float) -> Array:
    s = a + mu * c
    if limit == inf:
        return np.asarray(np.where(s <= 0, least, cap) * s)
    inside, speed = c <= mu * a, np.hypot(a, c)
    slant = np.hypot(1, mu)
    best = np.where(inside, limit * a / speed, limit / slant)
    p = np.where(s <= 0, least, np.clip(best, least, cap))
    most = np.where(inside, limit * speed, limit * s / slant)
    return np.asarray(np.where(p == best, most, a * p + c * _roughly_across(mu, p, limit)))


def _roughly_most_less(a: Array, c: Array, mu: float, least: float, limit: float) -> Array:
    inside, s = c <= mu * a, np.maximum(a + mu * c, 0.0)
    size = np.where(inside, np.hypot(a, c), s / np.hypot(1, mu))
    held = np.minimum(size, limit)
    p = np.where(inside, a, s / (1 + mu**2)) * np.divide(held, size, out=np.ones_like(size), where=size > 0)
    q = np.minimum(c, _roughly_across(mu, np.full_like(a, least), limit))
    return np.asarray(
        np.where(p < least, least * a + c * q - 0.5 * (least**2 + q * q), held * size - 0.5 * held**2)
    )


def _roughly_across(mu: float, p: Array, limit: float) -> Array:
    """The largest q that goes with p, or a little more, for the root of a difference is not exact."""
    if limit == inf:
        return mu * p
    return np.asarray(np.minimum(mu * p, np.sqrt(np.maximum(limit**2 * (1 + _ROUNDING) - p * p, 0.0))))


def is_least(proof: Proof) -> bool:
    """Whether the bound is no more than fingers that push with the least force have."""
    bound2, least2, k = Fraction(proof.bound) ** 2, Fraction(proof.min_normal) ** 2, proof.fingers
    return bound2 <= least2 * {"sum": k * k, "squares": k, "largest": 1}[proof.norm]


def wrong_limits(proof: Proof) -> list[str]:
    """What makes limits on forces none, in words."""
    limited = proof.max_force is not None or proof.min_normal != 0
    if not limited:
        return []
    largest = proof.min_normal if proof.max_force is None else proof.max_force
    if not 0 <= proof.min_normal <= largest < float("inf"):
        return ["proof: limits on forces must be 0 or more, the least no more than the largest"]
    if (proof.size, proof.norm) not in _NORMS:
        return ["proof: limits on forces go with the sizes of the four norms"]
    others = (proof.pairs, proof.tied, proof.movers)
    return ["proof: limits on forces go with one twist a box"] if any(o is not None for o in others) else []


def others_limits(chosen: Chosen, proof: Proof, is_level: bool) -> list[str]:
    """That a proof is about forces within limits that were not asked for, in words."""
    if proof.max_force is None and not proof.min_normal:
        return []
    largest, asked = (inf if limit is None else limit for limit in (proof.max_force, chosen.max_force))
    if is_level or largest < asked or proof.min_normal > chosen.min_normal:
        return ["the proof counts on limits of forces that are not those of the grasp"]
    return []


def _across(mu: Fraction, p: Fraction, limit: Fraction | None) -> Fraction:
    """The largest q that goes with p."""
    return mu * p if limit is None else min(mu * p, root_above(max(limit**2 - p**2, Fraction(0))))


def _sum(parts: Parts, most: Callable[[Fraction, Fraction], Fraction]) -> Fraction:
    return sum((max(most(a, c) for a, c in finger) for finger in parts), start=Fraction(0))
