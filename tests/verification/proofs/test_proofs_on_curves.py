"""The same on curves: straight cubics are sides, and no sampled force beats the bound of a stretch."""

from fractions import Fraction
from itertools import product

import numpy as np
import pytest

import regrasp as rg
from proofs import everything, limit, most_work, planar, planar_points, random_planar
from regrasp.verification.placed.cubic import CubicEdges
from regrasp.verification.placed.forces.eroded import is_sector

pytestmark = pytest.mark.oracle

KINDS = [(size, norm) for size in ("normal", "force") for norm in ("sum", "squares", "largest")]


def said(proof) -> str:
    return "; ".join(rg.verify(proof).violations)


def proven(proof) -> Fraction:
    return limit(proof, planar_points(proof))


def bent(vertices) -> np.ndarray:
    """The sides of a polygon as cubics."""
    p = np.array(vertices, dtype=float)
    q = np.roll(p, -1, axis=0)
    return np.stack([p, (2 * p + q) / 3, (p + 2 * q) / 3, q], axis=1)


@pytest.mark.parametrize(("size", "norm"), KINDS)
def test_cubics_that_are_straight_prove_as_much(size, norm) -> None:
    rng, seen = np.random.default_rng(4), 0
    for k in range(4):
        proof = random_planar(rng, size, norm, splits=k % 3)
        most = float(proven(proof))
        proof.control = bent(proof.vertices)
        if most > 0:
            seen += 1
            for factor, good in (1 - 1e-9, True), (1 + 1e-9, False):
                proof.bound = most * factor
                assert (said(proof) == "") == good, (k, factor)
    assert seen > 1


ROUND = np.array([[[3, -1], [4, 0.5], [3.5, 2], [2, 3]], [[2, 3], [0, 4], [-2, 2], [-2, 0]],
                  [[-2, 0], [-2, -3], [1, -3], [3, -1]]], dtype=float)  # fmt: skip
WAVES = np.array([[[0, 0], [1, 0], [1.5, 1], [3, 1]], [[3, 0], [2, 0], [1.5, 1], [0, 1]]])
CURVE = np.concatenate([ROUND, ROUND[:, ::-1], WAVES])
"""Curves that turn to the left, to the right, and one way and the other."""


def on_curve(edge: int, t: float):
    s, c = 1 - t, CURVE[edge]
    d = np.diff(c, axis=0)
    along = s * s * d[0] + 2 * s * t * d[1] + t * t * d[2]
    return s**3 * c[0] + 3 * s * s * t * c[1] + 3 * s * t * t * c[2] + t**3 * c[3], [-along[1], along[0]]


@pytest.mark.parametrize("size", ["normal", "force"])
def test_on_curves_no_force_does_more_than_the_bound_of_a_stretch(size) -> None:
    """Sampled places and forces; short stretches are bounded closely, in rationals and in doubles alike."""
    rng = np.random.default_rng(5)
    proof = planar(
        CURVE[:, 0], [[0, -1, 0]], [([(0, 0, 0, 1)], (0, 0), 0, (0, 0, 1))], control=CURVE, size=size
    )
    for k in range(60):
        proof.friction = float(rng.choice([0.0, 0.4, 1.5]))
        edges, edge = CubicEdges(proof), int(rng.integers(len(CURVE)))
        y = rng.normal(size=3)
        width = float(rng.choice([0.25, 1e-3]))
        lo = float(rng.uniform(0, 1 - width))
        hi = lo + width
        assert edges.turns_little(edge, Fraction(lo), Fraction(hi))
        most = float(edges.most(edge, Fraction(lo), Fraction(hi), [Fraction(x) for x in y]))
        best = max(most_work(proof, y, *on_curve(edge, t)) for t in np.linspace(lo, hi, 9))
        assert best <= most * (1 + 1e-9) + 1e-12, k
        if width == 1e-3:
            assert most <= best + 2e-5 * np.linalg.norm(y), k  # off by the square of the width
        rough = edges.roughly(np.array([edge]), np.array([lo]), np.array([hi]), np.array([y], float))[0]
        assert rough == pytest.approx(most, rel=1e-9, abs=1e-12), k


@pytest.mark.parametrize("size", ["normal", "force", "margin"])
def test_doubles_say_what_rationals_say_of_any_stretch(size) -> None:
    """Long ones and rough fingers too, whose cones together are more than half a turn."""
    rng, seen, wide = np.random.default_rng(7), set(), []
    node = ([(0, 0, 0, 1)], (0, 0), 0, (0, 0, 1))
    for k in range(80):
        friction = float(rng.choice([0.3, 1.5, 6.0]))
        margin = float(rng.uniform(0.05, 0.9)) * friction / np.hypot(1, friction) if size == "margin" else 0.0
        proof = planar(CURVE[:, 0], [[0, -1, 0]], [node], control=CURVE, size=size, friction=friction)
        proof.margin, proof.bound = 2 * margin, 2.0
        edges, edge = CubicEdges(proof), int(rng.integers(len(CURVE)))
        y = rng.normal(size=3) * 10.0 ** (2 * (k % 5) - 4)
        lo, hi = np.sort(rng.random(2))
        hi = min(hi, lo + float(rng.choice([1e-3, 0.25, 0.5])))
        if not edges.turns_little(edge, Fraction(lo), Fraction(hi)):
            continue
        exact = float(edges.most(edge, Fraction(lo), Fraction(hi), [Fraction(x) for x in y]))
        rough = edges.roughly(np.array([edge]), np.array([lo]), np.array([hi]), y[None])[0]
        best = (
            [most_work(proof, y, *on_curve(edge, t)) for t in np.linspace(lo, hi, 9)]
            if not margin
            else [-np.inf]
        )
        assert max(best) <= exact * (1 + 1e-9) + 1e-12, k
        if np.isfinite(rough):
            assert rough == pytest.approx(exact, rel=1e-7, abs=1e-12 * np.linalg.norm(y)), k
        elif size == "margin":  # too wide for what keeps a distance, or nearly
            proof.size = "force"
            whole = CubicEdges(proof).most(edge, Fraction(lo), Fraction(hi), [Fraction(x) for x in y])
            assert exact <= 2 * float(whole) * (1 + 1e-12)
            wide.append(exact == pytest.approx(2 * float(whole), rel=1e-12))
        seen.add((bool(np.isfinite(rough)), friction, exact > 0))
    assert (True, 6.0, True) in seen
    assert ((False, 6.0, True) in seen) == (size == "margin")
    assert sum(wide) >= 0.8 * len(wide)


def test_a_stretch_that_hardly_moves_is_judged_in_rationals() -> None:
    """Tangents of less than a fiftieth of the longest leg are lost in rounding."""
    for short, fine in ((0.021, True), (0.019, False)):
        control = np.array([[[0, 0], [short, 0], [1, 0.1], [2, 0.1]], [[2, 0.1], [2, 2], [0, 2], [0, 0]]])
        proof = planar(
            control[:, 0],
            [[0, -1, 0]],
            [([(0, 0, 0, 1)], (0, 0), 0, (0, 0, 1))],
            control=control,
            size="force",
        )
        longest = np.hypot(*(control[0, 2] - control[0, 1]))
        control[0, 1, 0] = short * longest
        for scale, hi in product((1e-3, 1.0, 1e3), (1e-9, 0.5)):  # one tangent that is short is enough
            proof.control = scale * control
            ends, y = (np.array([0.0]), np.array([hi])), np.array([[1.0, 2, 0]])
            assert np.isfinite(CubicEdges(proof).roughly(np.array([0]), *ends, y)[0]) == fine


def test_against_its_normal_a_finger_does_nothing() -> None:
    node = ([(0, 0, 0, 1)], (0, 0), 0, (0, 0, 1))
    for size, friction, scale in product(("normal", "force"), (0.0, 0.5), (1e-3, 1.0)):
        square = np.array([[0, 0], [2, 0], [2, 2], [0, 2]]) * 1.0
        proof = planar(square, [[0, -1, 0]], [node], size=size, friction=friction, control=bent(square))
        for way, most in (1, scale), (-1, 0.0):  # along a floor's normal, and against it
            y = [Fraction(0), Fraction(way * scale), Fraction(0)]
            found = CubicEdges(proof).most(0, Fraction(1, 4), Fraction(1, 2), y)
            assert float(found) == pytest.approx(most * 1.0, rel=1e-12, abs=0)


def test_half_a_turn_is_no_sector() -> None:
    for tiny, good in (Fraction(1, 10**30), True), (Fraction(0), False), (Fraction(-1, 10**30), False):
        assert is_sector((Fraction(1), Fraction(0)), (Fraction(-1), tiny)) == good


def test_stretches_turn_by_less_than_a_quarter() -> None:
    for short, good in (0.0, False), (1e-12, True), (-1e-12, False):
        quarter = np.array([[[0, 0], [1, 0], [2, 1], [2 + short, 2]]])
        node = ([(0, 0, 0, 1)], (0, 0), 0, (0, 0, 1))
        for control in (quarter, quarter[:, ::-1]):
            edges = CubicEdges(planar(control[:, 0], [[0, -1, 0]], [node], control=control))
            assert edges.turns_little(0, Fraction(0), Fraction(1)) == good


def test_stretches_of_curves_that_turn_too_far_prove_nothing() -> None:
    """A hairpin, whose tangents at both ends are opposite."""
    hairpin = np.array([[[0, 0], [2, 0], [2, 1], [0, 1]], [[0, 1], [-1, 1], [-1, 0], [0, 0]]], dtype=float)
    for edge, hi, good in (0, 1.0, False), (0, 0.25, True), (1, 1.0, False), (1, 0.25, True):
        hairpin = np.roll(hairpin, edge, axis=0)
        sides = np.array([[edge, edge, edge + hi]])
        node = (everything(sides, 1), (0, 0), 0, (0.0, 1.0, 0.0))
        proof = planar(hairpin[:, 0], [[0, -1, 0]], [node], sides=sides, control=hairpin, bound=1e-6)
        found = said(proof)
        assert (found == "") == good
        assert good or "side 0 is no stretch of an edge" in found
