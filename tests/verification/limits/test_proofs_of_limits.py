"""Proofs about forces with a limit and a least normal part: against all forces of a grid, and spoiled."""

from dataclasses import replace
from fractions import Fraction
from functools import cache

import numpy as np
import pytest

import regrasp as rg
from proofs import bent, everything, planar, random_planar
from regrasp.verification.placed.forces.limited import (
    most_less_half_square,
    most_work,
    roughly_excluded,
)

pytestmark = pytest.mark.oracle

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
LOADS = rg.LoadSet.hull(
    [rg.Wrench([0, -1], 0.2), rg.Wrench([0, -1], -0.2), rg.Wrench([0.5, -1]), rg.Wrench([-0.5, -1])]
)


def forces(mu: float, least: float, cap: float, limit: float, count: int = 4001) -> np.ndarray:
    """(m, 2) normal part and part across, on the boundary of what is allowed, nowhere far apart."""
    p = np.linspace(least, min(cap, limit), count)
    p = np.concatenate([p, [limit / np.hypot(1, mu)]])
    p = p[(p >= least) & (p <= min(cap, limit))]
    q = np.minimum(mu * p, np.sqrt(np.maximum(limit**2 - p * p, 0)))
    inner = np.linspace(0, 1, count) * min(mu * least, np.sqrt(max(limit**2 - least**2, 0)))
    return np.concatenate([np.stack([p, q], 1), np.stack([np.full_like(inner, least), inner], 1)])


def test_what_a_force_within_limits_does_is_the_most_of_all() -> None:
    rng, seen = np.random.default_rng(0), set()
    for _ in range(200):
        mu, least = float(rng.choice([0, 0.25, 1, 3])), float(rng.choice([0, 0.5, 1]))
        limit = float(rng.choice([1.0, 1.25, 2.0, 5.0]))
        cap = float(rng.choice([least, 1.1, 1.5, 9.0]))
        if cap < least:
            continue
        a, c = float(rng.normal()), float(abs(rng.normal()) * rng.choice([0, 0.01, 1, 3]))
        exact = [Fraction(x) for x in (a, c, mu, least)]
        allowed = forces(mu, least, cap, limit)
        best = float((allowed @ [a, c]).max())
        found = float(most_work(*exact, Fraction(cap), Fraction(limit)))
        assert best - 1e-12 <= found <= best + 1e-4 * (abs(a) + c) * limit, (a, c, mu, least, cap, limit)
        unlimited = float(most_work(*exact, Fraction(cap), None))
        assert unlimited == pytest.approx(max(p * (a + mu * c) for p in (least, cap)), abs=1e-12)
        inside = forces(mu, least, limit, limit, 301)
        grid = np.concatenate([inside * s for s in np.linspace(0, 1, 61)])  # forces inside of the circle
        grid = grid[grid[:, 0] >= least]
        squared = float((grid @ [a, c] - 0.5 * (grid**2).sum(axis=1)).max())
        found = float(most_less_half_square(*exact, Fraction(limit)))
        assert squared - 1e-12 <= found <= squared + 2e-3 * limit**2, (a, c, mu, least, limit)
        seen.add((a + mu * c <= 0, c <= mu * a, cap < limit))
    assert len(seen) == 8


def judged(proof, h) -> float:
    """Of one box and one load, by how much its twist exceeds the most that forces do by ``h``."""
    y, total = proof.twists[0], 0.0
    for (first, last), (lo, hi) in zip(proof.arcs[0].tolist(), proof.ends[0].tolist(), strict=True):
        found = []
        for j in range(first, last + 1):
            edge, a, b = proof.sides[j]
            p, q = (proof.vertices[(int(edge) + k) % len(proof.vertices)] for k in (0, 1))
            t = (q - p) / np.hypot(*(q - p))
            for u in (lo if j == first else a, hi if j == last else b):
                x, z = p + (u - int(edge)) * (q - p) - proof.centre_of_mass
                v = np.array([y[0] - y[2] * z, y[1] + y[2] * x])
                found.append(h(v @ [-t[1], t[0]], abs(v @ t)))
        total += max(found)
    return float(-proof.loads[0] @ y - total)


@pytest.mark.parametrize("curved", [False, True])
@pytest.mark.parametrize("limited", [False, True])
@pytest.mark.parametrize(
    ("size", "norm"), [("normal", "sum"), ("normal", "largest"), ("force", "largest"), ("force", "squares")]
)
def test_a_box_is_excluded_where_no_forces_of_less_do_the_work(
    size: str, norm: str, limited: bool, curved: bool
) -> None:
    rng, seen = np.random.default_rng(1), set()
    for _ in range(10):
        proof = random_planar(rng, size, norm, 0)
        proof.twists = proof.twists * 0.3
        proof.min_normal = float(rng.choice([0.125, 0.375]))
        proof.max_force = float(rng.choice([0.75, 2.0])) if limited else None
        proof.bound = 1.5
        if curved:
            proof.control = bent(proof.vertices)
        limit = proof.max_force or np.inf
        each, cap = min(limit, proof.bound), proof.bound if size == "normal" else np.inf
        high = (limit if limit < np.inf else 99.0) if size == "normal" else each
        allowed = forces(proof.friction, proof.min_normal, cap, high, 301)
        cost = {
            "sum": lambda f: f[:, 0],
            "squares": lambda f: 0.5 * (f**2).sum(axis=1),
            "largest": lambda f: 0.0 * f[:, 0],
        }[norm]
        inside = np.concatenate([allowed * s for s in np.linspace(0, 1, 61)])
        inside = inside[inside[:, 0] >= proof.min_normal]
        needs = {"sum": proof.bound, "squares": 0.5 * proof.bound**2, "largest": 0.0}[norm]

        def by_cost(a, c, inside=inside, cost=cost) -> float:
            return float((inside @ [a, c] - cost(inside)).max())

        def by_size(a, c, allowed=allowed) -> float:
            return float((allowed @ [a, c]).max())

        load = proof.loads[0].copy()
        done = -load @ proof.twists[0]
        # how much work the load would have to ask for, by the one or the other reason
        least = done - max(judged(proof, by_cost) - needs, judged(proof, by_size))
        for off, good in ((0.02, True), (-0.02, False)):
            wanted = least + off * max(abs(least), 1.0)
            proof.loads[0] = load * (wanted / done)
            assert rg.verify(proof).ok == good, (wanted, least, vars(proof))
            seen.add((good, proof.fingers))
        proof.loads[0] = load
    assert len(seen) >= 4


def test_the_least_forces_need_no_twist() -> None:
    square = np.array([[0.0, 0], [4, 0], [4, 4], [0, 4]])
    sides = np.array([[0, 0, 1.0], [2, 2, 3]])
    for norm, size, least in (
        ("sum", "normal", 1.0),
        ("largest", "normal", 0.5),
        ("squares", "force", 0.5**0.5),
    ):
        node = (everything(sides, 2), (0, 0), 0, (0.0, 0.0, 0.0))
        proof = planar(square, [(0, -1, 0)], [node], sides=sides, size=size, norm=norm, min_normal=0.5)
        proof.bound = least * (1 - 1e-12)
        assert rg.verify(proof).ok
        proof.bound = least * (1 + 1e-12)
        assert not rg.verify(proof).ok


@cache
def chosen(objective: str) -> rg.ChosenGrasp:
    return rg.choose_grasp(
        BRACKET, 3, LOADS, friction=0.4, objective=objective, min_normal=0.2, max_force=0.9
    )


@pytest.mark.parametrize("objective", ["sum_normal", "peak_normal", "peak", "effort"])
def test_limits_of_a_proof_that_are_touched_are_seen(objective: str) -> None:
    found = chosen(objective)
    proof = found.certificate
    assert rg.verify(found).ok
    assert rg.ChosenGrasp.from_dict(found.to_dict()) == found
    data = proof.to_dict()
    for name, value in (("min_normal", 0.21), ("max_force", 0.89)):
        with pytest.raises(rg.InvalidInput, match="digest"):
            type(proof).from_dict({**data, name: value})
        changed = replace(found, certificate=replace(proof, **{name: value}))
        assert "counts on limits of forces" in str(rg.verify(changed).violations)
    # what was counted on is needed
    assert not rg.verify(replace(proof, min_normal=0.0)).ok
    assert not rg.verify(replace(proof, bound=proof.bound * 1.001)).ok
    leaf = int(np.flatnonzero((proof.children[:, 1] == 0) & (proof.number >= 0))[2])
    for factor in (-1.0, 0.0):
        twists = np.array(proof.twists)
        twists[leaf] *= factor
        assert not rg.verify(replace(proof, twists=twists)).ok


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"min_normal": 1.0}, "the least no more than the largest"),
        ({"min_normal": -0.1}, "limits on forces must be 0 or more"),
        ({"max_force": np.nan}, "limits on forces must be 0 or more"),
        ({"size": "force", "norm": "sum"}, "the sizes of the four norms"),
        # what squares of forces cost is more than squares of their normal parts
        ({"size": "normal", "norm": "squares"}, "the sizes of the four norms"),
        ({"norm": "largest", "pairs": np.zeros((0, 2), int), "seconds": np.zeros((0, 3))}, "one twist a box"),
    ],
)
def test_limits_that_are_none_are_refused(changes, words: str) -> None:
    proof = replace(chosen("sum_normal").certificate, **changes)
    assert words in str(rg.verify(proof).violations)


@pytest.mark.parametrize("name", ["max_force", "min_normal"])
def test_limits_are_numbers(name: str) -> None:
    for value in ("1", 1j, [1.0], np.ones(1)):
        with pytest.raises(rg.InvalidInput, match=f"{name} of a plan must be a number"):
            rg.verify(replace(chosen("sum_normal").certificate, **{name: value}))


def test_doubles_decide_nearly_all_boxes_and_none_wrongly() -> None:
    rng = np.random.default_rng(5)
    clear = 0
    for norm in ("sum", "largest", "squares"):
        for _ in range(40):
            proof = random_planar(rng, "force" if norm == "squares" else "normal", norm, 0)
            proof.min_normal, proof.bound = 0.25, 1.0
            proof.max_force = float(rng.choice([0.5, 3.0]))
            k = proof.fingers
            a, c = rng.normal(size=(1, k)), abs(rng.normal(size=(1, k)))
            parts = [[(Fraction(x), Fraction(z))] for x, z in zip(a[0].tolist(), c[0].tolist(), strict=True)]
            work = float(rng.uniform(0, 4))
            told = roughly_excluded(proof, np.array([work]), np.array([1e-13]), lambda most: most(a, c))  # noqa: B023
            from regrasp.verification.placed.forces.limited import is_excluded

            exact = is_excluded(proof, Fraction(work), parts)
            assert exact == bool(told[0])
            clear += exact
    assert 20 < clear < 100
