"""Proofs about forces that keep a distance from the edges of their cones: against corners of their region."""

from math import atan, sin

import numpy as np
import pytest

import regrasp as rg
from proofs import everything, planar, random_planar
from regrasp.verification.placed.straight import StraightEdges

pytestmark = pytest.mark.oracle


def most(v, normal, mu: float, limit: float, margin: float) -> float:
    """The most of v . f over |f| <= limit whose distance from both edges is margin or more, by sampling."""
    n = np.array(normal) / np.hypot(*normal)
    t = np.array([n[1], -n[0]])
    half = atan(mu)
    tip = margin / sin(half) * n
    widest = half - np.arcsin(margin / limit)
    angles = np.linspace(-widest, widest, 1001)
    arc = limit * (np.cos(angles)[:, None] * n + np.sin(angles)[:, None] * t)
    return float(max(arc @ v) if tip @ v < max(arc @ v) else tip @ v)


@pytest.mark.parametrize("bent", [False, True])
def test_boxes_are_excluded_where_no_forces_do_the_work(bent) -> None:
    rng, seen = np.random.default_rng(0), set()
    for _ in range(14):
        proof = random_planar(rng, "margin", "largest", 0)
        proof.friction, proof.bound = float(rng.choice([0.5, 1.0, 2.0])), 1.0
        proof.margin = float(rng.uniform(0.05, 0.9)) * sin(atan(proof.friction))
        if bent:
            p = np.asarray(proof.vertices)
            q = np.roll(p, -1, axis=0)
            proof.control = np.stack([p, (2 * p + q) / 3, (p + 2 * q) / 3, q], axis=1)
        y, total = proof.twists[0], 0.0
        for (first, last), (lo, hi) in zip(proof.arcs[0].tolist(), proof.ends[0].tolist(), strict=True):
            found = []
            for j in range(first, last + 1):
                edge, a, b = proof.sides[j]
                p, q = (proof.vertices[(int(edge) + k) % len(proof.vertices)] for k in (0, 1))
                for u in (lo if j == first else a, hi if j == last else b):
                    x, z = p + (u - int(edge)) * (q - p) - proof.centre_of_mass
                    v = np.array([y[0] - y[2] * z, y[1] + y[2] * x])
                    found.append(most(v, [p[1] - q[1], q[0] - p[0]], proof.friction, 1.0, proof.margin))
            total += max(found)
        for factor, good in (1 + 1e-4, True), (1 - 1e-4, False):
            if total <= 0:
                continue
            load = proof.loads[0]
            proof.loads[0] = load * (total * factor / -(load @ y))
            assert rg.verify(proof).ok == good, factor
            proof.loads[0] = load
            seen.add((good, proof.fingers))
    assert len(seen) >= 2


def test_margins_go_with_their_size() -> None:
    node = (everything([[0, 0, 1.0]], 1), (0, 0), 0, (0.0, 1.0, 0.0))
    for changes, words in (
        ({}, ""), ({"margin": 0.0}, "margin must be 0 or more"),
        ({"margin": -1.0}, "margin must be 0 or more"),
        ({"margin": np.inf}, "margin must be 0 or more"), ({"size": "force"}, "goes with a size of its name"),
        ({"norm": "sum"}, "a margin is of a largest force"), ({"friction": 0.0}, "and friction"),
    ):  # fmt: skip
        given = {"size": "margin", "norm": "largest", "margin": 0.1, "bound": 0.1} | changes
        proof = planar(
            [[-2, -1], [3, -1], [0, 5]], [[0, -1, 0]], [node], sides=np.array([[0, 0, 1.0]]), **given
        )
        found = "; ".join(rg.verify(proof).violations)
        assert words in found
        assert bool(words) == bool(found)


def test_doubles_say_what_rationals_say() -> None:
    from fractions import Fraction

    rng = np.random.default_rng(1)
    for _ in range(60):
        proof = random_planar(rng, "margin", "largest", 0)
        proof.friction, proof.bound = float(rng.choice([0.5, 1.0, 2.0])), 1.0
        proof.margin = float(rng.uniform(0.05, 0.9)) * sin(atan(proof.friction))
        edges, edge, y = StraightEdges(proof), int(rng.integers(len(proof.vertices))), rng.normal(size=3)
        lo, hi = np.sort(rng.random(2))
        exact = float(edges.most(edge, Fraction(lo), Fraction(hi), [Fraction(x) for x in y]))
        rough = edges.roughly(np.array([edge]), np.array([lo]), np.array([hi]), np.array([y], float))[0]
        assert rough == pytest.approx(exact, rel=1e-7, abs=1e-12)
