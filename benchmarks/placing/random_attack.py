"""Random placements against a value and a bound that a search found: is one better, how near do they come?

Placements that cannot hold the loads at a level within a tenth of the value, by weak duality, go first
(``random_twists``), then those that cannot at the bound; what is left is judged exactly, pairs by the
interval of their squeeze (``random_pairs``), triples by ``choose_states``, whose forces are checked one by
one. Nothing of it is part of the search.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

import regrasp as rg
from random_pairs import pairs_hold
from random_twists import Rejection
from regrasp.outline.curve import CurveBoundary

Array = np.ndarray
Judge = Callable[[Array, Array], Array]
AT_ONCE = 20_000  # placements
SLACK = 1e-6  # of a value, by which solvers may be off
AROUND = 20_000  # drawn around the value's besides
SHOWN = 20  # of those within a tenth are judged exactly: that there are some shows that good ones are seen
BALANCED = rg.Wrench([0, -1]).vector


def attack(
    outline: rg.Outline, fingers: int, friction: float, loads: Array, objective: str, near: float | None,
    bound: float | None, limit: float, count: int, places: Array,
) -> dict[str, Any]:  # fmt: skip
    """``random`` placements, of which ``near`` hold the loads at that level, ``better`` at the bound.

    Some more are drawn around ``places``, at distances of 1e-6 to 0.1 of the length, of which ``around`` are
    near, too. Of those not rejected the first ``SHOWN`` of a kind are judged exactly, and all at the bound.
    """
    rng, places_at = np.random.default_rng(fingers), on_outline(outline)
    bound = None if bound is None else bound * (1 + (SLACK if _is_more(objective) else -SLACK))
    reach = float(np.linalg.norm(outline.points(outline.sample(200)), axis=1).max())
    judges: list[tuple[Judge, Judge]] = []
    for level in (near, bound):
        given, at = loads, level
        if objective == "answered":
            given, at = BALANCED + 0.1 * (level or 0.0) * loads, None
        quick = Rejection(given, friction, objective, at, limit, reach, fingers)
        judges.append((quick.left, _exact(fingers, friction, given, objective, at, limit)))
    left: dict[str, list[tuple[Array, Array]]] = {"near": [], "around": [], "better": []}
    kinds = [("near", count)] + [("around", AROUND)] * bool(len(places))
    for kind, many in kinds:
        for first in range(0, many, AT_ONCE):
            shape = min(AT_ONCE, many - first), fingers
            s = rng.uniform(0, outline.length, shape)
            if kind == "around":
                s = places + outline.length * 10 ** rng.uniform(-6, -1, (len(s), 1)) * rng.normal(size=shape)
            positions, normals = places_at(s)
            for (quick, _), what in zip(judges, (kind, "better"), strict=True):
                if what == "better" or sum(len(p) for p, _ in left[what]) < SHOWN:
                    held = quick(positions, normals)
                    positions, normals = positions[held], normals[held]
                    left[what].append((positions, normals))
    found = {"random": count}
    for what, given in left.items():
        given = [(np.zeros((0, fingers, 2)),) * 2, *given]
        positions, normals = (np.concatenate(each) for each in zip(*given, strict=True))
        some = slice(None if what == "better" else SHOWN)
        exact = judges[what == "better"][1]
        found[what] = int(exact(positions[some], normals[some]).sum())
    return found


def on_outline(outline: rg.Outline) -> Callable[[Array], tuple[Array, Array]]:
    """Points and inward unit normals at arc lengths; on a curve at a millionth of it or so from there."""
    curve, length = outline.boundary, outline.length
    if not isinstance(curve, CurveBoundary):
        return lambda s: (outline.points(s % length), outline.normals(s % length))
    known = np.linspace(0, length, 4097)
    u = np.append(curve.parameter(known[:-1]), curve.breaks[-1])

    def places_at(s: Array) -> tuple[Array, Array]:
        at = np.interp(s % length, known, u)
        velocity = curve.at(at, 1)
        inward = np.stack([-velocity[..., 1], velocity[..., 0]], axis=-1)
        unit = inward / np.linalg.norm(inward, axis=-1, keepdims=True)
        return curve.at(at) - outline.centre_of_mass, unit

    return places_at


def _is_more(objective: str) -> bool:
    return objective in ("force", "answered")


def _exact(
    fingers: int, friction: float, loads: Array, objective: str, level: float | None, limit: float
) -> Judge:
    """Which placements hold all loads at a level."""

    def judge(positions: Array, normals: Array) -> Array:
        good = np.arange(len(positions))
        for load in loads:
            if len(good):
                holds = pairs_hold if fingers == 2 else _triples_hold
                good = good[holds(positions[good], normals[good], friction, load, objective, level, limit)]
        result = np.zeros(len(positions), dtype=bool)
        result[good] = True
        return result

    return judge


def _triples_hold(
    positions: Array, normals: Array, friction: float, load: Array, objective: str, level: float | None,
    limit: float,
) -> Array:  # fmt: skip
    """As ``pairs_hold``, by ``choose_states``."""
    judged = "peak" if objective == "answered" else objective
    found = rg.choose_states(
        positions, normals, friction, load[:2], load[2], objective=judged, max_force=limit
    )
    held: Array = found.held.copy()
    if level is not None:
        values = found.values[held]
        held[held] = values >= level if objective == "force" else values <= level
    return held
