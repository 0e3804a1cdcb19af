"""How far a boundary is from a circle, by values of its polynomials, and what turned fingers may do more."""

from fractions import Fraction
from math import comb, inf, nextafter

import numpy as np
import pytest

import regrasp as rg
from proofs import planar
from regrasp.verification.placed.curves.circles import play_of

pytestmark = pytest.mark.oracle


def ring(count: int, radii=1.0, handle: float = 1.0, tilt: float = 0.0) -> np.ndarray:
    """(count, 4, 2) cubics around the origin, nearly arcs of a circle if all radii are one."""
    angle = 2 * np.pi * np.arange(count) / count
    point = np.broadcast_to(radii, count)[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
    ahead = np.column_stack([-np.sin(angle + tilt), np.cos(angle + tilt)]) * handle
    ahead *= 4 / 3 * np.tan(np.pi / count / 2)
    after = np.roll(point, -1, axis=0)
    return np.stack([point, point + ahead, after - np.roll(ahead, -1, axis=0), after], axis=1)


def proof_of(control, **changes):
    """Of one finger, which stays at the beginning."""
    count = len(control)
    sides = np.array([[e, e, e + 1] for e in range(count)], dtype=float)
    node = ([(0, 0, 0.0, 0.0)], (0, 0), 0, (-1.0, 0.25, 0.5))
    given = {"size": "force", "norm": "largest", "sides": sides, "control": control, "turned": True}
    return planar(control[:, 0], [(1.0, 0, 0)], [node], **given | changes)


def exactly(control):
    return [[(Fraction(x), Fraction(y)) for x, y in edge] for edge in control.tolist()]


def coefficients(degree: int, of) -> np.ndarray:
    """In Bernstein's basis, of a polynomial given by its values."""
    t = 0.5 - 0.5 * np.cos(np.pi * (np.arange(degree + 1) + 0.5) / (degree + 1))
    basis = [[comb(degree, k) * x**k * (1 - x) ** (degree - k) for k in range(degree + 1)] for x in t]
    return np.linalg.solve(basis, [of(x) for x in t])


def measured(control) -> tuple[float, float]:
    squares, along, across = [], [], []
    for edge in control:
        legs = np.diff(edge, axis=0)

        def point(t, edge=edge):
            return sum(comb(3, k) * t**k * (1 - t) ** (3 - k) * edge[k] for k in range(4))

        def tangent(t, legs=legs):
            return sum(comb(2, k) * t**k * (1 - t) ** (2 - k) * legs[k] for k in range(3))

        squares += coefficients(6, lambda t, p=point: p(t) @ p(t)).tolist()
        along += coefficients(5, lambda t, p=point, d=tangent: d(t) @ p(t)).tolist()
        across += coefficients(
            5, lambda t, p=point, d=tangent: p(t)[0] * d(t)[1] - p(t)[1] * d(t)[0]
        ).tolist()
    a, b, c = min(squares), max(squares), max(np.abs(along)) / min(across)
    return (b - a) / (2 * a) + 2 * c, b**0.5


SAW = [1.0, 1.02, 1.04, 1.06, 1.08, 1.1]  # rises slowly, and falls at once


@pytest.mark.parametrize("control", [
    ring(5), ring(8, 3.0), ring(6, SAW), ring(6, SAW[::-1]), ring(7, 1.0, 1.3), ring(4, 1.0, 0.7),
    ring(9, tilt=0.02), ring(9, tilt=-0.02), ring(5, [1, 1, 1, 2, 1])[:, :, ::-1] * [1, -1],
])  # fmt: skip
def test_play_is_that_of_the_polynomials(control) -> None:
    found = play_of(proof_of(control), exactly(control))
    assert found is not None
    assert tuple(map(float, found)) == pytest.approx(measured(control), rel=1e-9, abs=1e-12)


def test_what_is_no_circle() -> None:
    control = ring(6)
    proof = proof_of(control)

    def is_one(control=control, **changes) -> bool:
        return play_of(proof_of(control, **changes), exactly(control)) is not None

    assert is_one()
    sides = proof.sides
    assert not is_one(sides=sides[1:])
    assert not is_one(sides=sides[:-1])
    assert not is_one(sides=np.delete(sides, 2, axis=0))
    halved = np.insert(sides, 3, [2, 2.5, 3], axis=0)
    halved[2, 2] = 2.5
    assert is_one(sides=halved)
    assert not is_one(control[:, ::-1])  # clockwise
    for edge in range(6):
        open_ = control.copy()
        open_[edge, 3, 0] = nextafter(open_[edge, 3, 0], inf)
        assert not is_one(open_)
    assert is_one(control + np.array([0.5, 0]))
    assert not is_one(ring(2, handle=0.5))  # around the origin, but coefficients of |p|^2 are below 0
    assert not is_one(control + np.array([1.5, 0]))


@pytest.mark.parametrize("size", ["normal", "force"])
def test_fingers_do_so_much_more(size) -> None:
    """The finger at (1, 0) pushes along (-1, 0): along a twist (-1, 1/4, 1/2) it does what (-1, 3/4) does."""
    control = ring(16)
    friction = 0.5
    proof = proof_of(control, size=size, friction=friction)
    play, reach = measured(control)
    assert 1e-9 < play < 1e-3
    edge = 1 + friction * 0.75
    most = edge / np.hypot(1, friction) if size == "force" else edge
    limit = 1 / (most + play * (1 + friction) * (1.25 + 0.5 * reach))
    for factor, good in (1 - 1e-12, True), (1 + 1e-12, False), (1 + 1e-9, False):
        proof.bound = limit * factor
        found = "; ".join(rg.verify(proof).violations)
        assert found == ("" if good else "proof: the twist of box 0 does not exclude it"), factor
    assert "box 0 must" in "; ".join(rg.verify(proof_of(control, turned=False)).violations)
