"""Whether contacts are on sides of a proof that are curves, and which wrenches fingers make: at the limit."""

from fractions import Fraction

import numpy as np
import pytest

import regrasp as rg
from proofs import planar
from regrasp.verification.exact import RESOLUTION
from regrasp.verification.placed.arc_lengths import lengths_to, points_at
from regrasp.verification.placed.touching import Touching
from regrasp.verification.placed.whole_sets import makes_ball

pytestmark = pytest.mark.oracle

CURVE = np.array([[[3, -1], [4, 0.5], [3.5, 2], [2, 3]], [[2, 3], [0, 4], [-2, 2], [-2, 0]],
                  [[-2, 0], [-2, -3], [1, -3], [3, -1]]], dtype=float)  # fmt: skip
NODE = ([(0, 0, 0, 1)], (0, 0), 0, (0, 0, 1))


def at(u: float, curve: np.ndarray = CURVE) -> tuple[np.ndarray, np.ndarray]:
    """A point and the unit tangent there."""
    c, t = curve[int(u) % 3], u % 1
    s, d = 1 - t, np.diff(c, axis=0)
    along = s * s * d[0] + 2 * s * t * d[1] + t * t * d[2]
    return s**3 * c[0] + 3 * s * s * t * c[1] + 3 * s * t * t * c[2] + t**3 * c[3], along / np.hypot(*along)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_contacts_on_curves_touch_to_the_resolution(scale) -> None:
    sides = np.array([[0, 0.25, 1.0], [1, 1.0, 2.0], [2, 2.0, 2.5]])
    proof = planar(scale * CURVE[:, 0], [[0, -1, 0]], [NODE], sides=sides, control=scale * CURVE)
    proof.centre_of_mass = scale * np.array([0.5, 0.25])
    touching, reach = Touching(proof), scale * np.hypot(*(CURVE.reshape(-1, 2) - [0.5, 0.25]).T).max()
    assert touching.reach == pytest.approx(reach)

    def touches(u: float, off: float = 0.0, turn: float = 0.0) -> bool:
        p, t = at(u)
        n = np.array([-t[1] * np.cos(turn) - t[0] * np.sin(turn), t[0] * np.cos(turn) - t[1] * np.sin(turn)])
        return rg.Contact(scale * (p - [0.5, 0.25]) + off * np.array([-t[1], t[0]]), n, 0.5) in touching

    size = float(RESOLUTION) * reach
    for u in np.linspace(0.26, 2.49, 9):
        assert touches(u)
        for way in (1, -1):
            assert touches(u, way * 0.9 * size)
            assert not touches(u, way * 1.1 * size)
            assert touches(u, turn=way * 3e-12)
            assert not touches(u, turn=way * 4e-12)
        assert not touches(u, turn=np.pi)
    for u in (0.0, 0.1, 0.24, 2.51, 2.9):
        assert not touches(u)
    lengths = [
        np.hypot(*np.diff([at(u)[0] for u in np.linspace(a, b - 1e-12, 400)], axis=0).T).sum()
        for a, b in ((0.25, 1), (1, 2), (2, 2.5), (0, 1), (2, 3))
    ]
    share = sum(lengths[:3]) / sum(lengths[i] for i in (1, 3, 4))
    assert touching.share == pytest.approx(share, rel=1e-5)


@pytest.mark.parametrize(
    ("curve", "lo", "hi"),
    [
        ([[0, 0], [0.9, 1], [0.1, 1], [1, 0]], 0.25, 0.95),  # turns back sharply
        ([[0, 0], [4, 4], [-3, 4], [1, 0]], 0.0, 1.0),  # meets itself
    ],
)
def test_the_nearest_of_many_points_is_where_steps_begin(curve, lo, hi) -> None:
    edges = np.array([curve, [[1, 0], [1, -2], [0, -2], [0, 0]]], dtype=float)
    sides = np.array([[0, lo, hi], [1, 1.0, 2.0]])
    touching = Touching(planar(edges[:, 0], [[0, -1, 0]], [NODE], sides=sides, control=edges))
    for u in np.linspace(lo, min(hi, 0.999), 40):
        p, t = at(u, edges)
        assert rg.Contact(p, [-t[1], t[0]], 0.5) in touching, u


def test_a_stretch_that_is_left_out_counts_on_a_curve() -> None:
    """However many sides the rest has: by length, not by chords."""
    u = np.array([0.0, *np.linspace(1e-6, 3, 41)])
    u = np.unique(np.concatenate([u, [1.0, 2.0]]))
    for first in 0, 1:
        ends = zip(u[first:-1], u[first + 1 :], strict=True)
        sides = np.array([[int(a), a, b] for a, b in ends])
        share = Touching(planar(CURVE[:, 0], [[0, -1, 0]], [NODE], sides=sides, control=CURVE)).share
        length = lengths_to(CURVE, np.ones(3)).sum()
        skipped = first * 1e-6 * 3 * np.hypot(*(CURVE[0, 1] - CURVE[0, 0])) / length
        assert share == pytest.approx(1 - skipped, abs=1e-10)


def test_places_at_lengths() -> None:
    """Of edges of even speed, 5, 4 and 3 long, as polygon and as cubics; once around is nothing."""
    corners = np.array([[0.0, 0], [3, 4], [3, 0]])
    ends = np.roll(corners, -1, axis=0)
    edges = np.stack([corners + (ends - corners) * k / 3 for k in range(4)], axis=1)
    for control in None, edges:
        for s, p in (
            (0, [0, 0]),
            (2.5, [1.5, 2]),
            (5, [3, 4]),
            (6, [3, 3]),
            (11.25, [0.75, 0]),
            (12, [0, 0]),
        ):
            for around in (0.0, 12.0, -12.0):
                found = points_at([s + around], corners, control)
                assert found == pytest.approx(np.array([p]), abs=1e-13), (s, around)
    line = np.array([[[0, 0], [0, 0], [1, 0], [1, 0]], [[1, 0], [1, 0], [0, 0], [0, 0]]], dtype=float)
    assert points_at([0.25, 1.0, 1.5], line[:, 0], line) == pytest.approx(
        np.array([[0.25, 0], [1, 0], [0.5, 0]]), abs=1e-14
    )


def test_lengths_of_edges_that_are_known() -> None:
    """Of a straight one of even speed and of a parabola y = x^2, raised to a cubic."""
    line = [[0, 0], [1, 1], [2, 2], [3, 3]]
    parabola = [[0, 0], [1 / 3, 0], [2 / 3, 1 / 3], [1, 1]]
    for end in (0.0, 0.3, 1.0):
        found = lengths_to(np.array([line, parabola]), np.array([end, end]))
        root = np.sqrt(1 + 4 * end * end)
        length = end * root / 2 + np.arcsinh(2 * end) / 4
        assert found == pytest.approx([3 * end * 2**0.5, length], rel=1e-13)
        edges = np.array([parabola, [[1, 1], [2 / 3, 2 / 3], [1 / 3, 1 / 3], [0, 0]]])
        assert points_at([length], edges[:, 0], edges) == pytest.approx(
            np.array([[end, end * end]]), abs=1e-13
        )


def test_shares_of_straight_sides() -> None:
    sides = np.array([[0, 0.25, 0.75], [2, 2.0, 3.0]])
    square = planar([[0, 0], [2, 0], [2, 1], [0, 1]], [[0, -1, 0]], [NODE], sides=sides)
    assert Touching(square).share == pytest.approx(3 / 6, rel=1e-12)
    for x, on in (0.5, True), (1.5, True), (1.5 + 1e-9, False), (0.5 - 1e-9, False):
        assert (rg.Contact([x, 0], [0, 1], 0.5) in Touching(square)) == on


def test_fingers_that_make_no_torque_make_no_ball() -> None:
    """Without friction, or with all lines of force through one point: the sum is flat."""
    line = rg.Grasp([rg.Contact([x, 0], [-np.sign(x), 0], 0.0) for x in (-1, 1)])
    assert not makes_ball(line, 1.0, 1.0, Fraction(0))
    one = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.0)])
    assert not makes_ball(one, 1.0, 1.0, Fraction(0))
    ring = rg.Grasp([rg.Contact([np.cos(a), np.sin(a)], [-np.cos(a), -np.sin(a)], 0.0) for a in (0, 2, 4)])
    assert not makes_ball(ring, 1.0, 1.0, Fraction(1, 1000))


@pytest.mark.parametrize("length", [0.5, 2.0])
@pytest.mark.parametrize("limit", [1.0, 3.0])
def test_balls_are_as_wide_as_fingers_reach(length, limit) -> None:
    """Against the support of the sum of their triangles in many directions."""
    grasp = rg.Grasp(
        [
            rg.Contact([-1, 0.2], [1, 0], 0.7),
            rg.Contact([1, 0], [-1, 0], 0.5),
            rg.Contact([0, 1], [0.1, -1], 0.6),
        ]
    )
    edges = []
    for c in grasp:
        n, t = np.asarray(c.normal), np.array([-c.normal[1], c.normal[0]])
        for side in (-c.friction, c.friction):
            f = limit * (n + side * t)
            edges.append([*f, (c.position[0] * f[1] - c.position[1] * f[0]) / length])
    edges = np.array(edges).reshape(3, 2, 3)
    rng = np.random.default_rng(0)
    u = rng.normal(size=(20_000, 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    support = np.maximum(np.einsum("ijk,mk->mij", edges, u).max(axis=2), 0).sum(axis=1)
    reach = float(support.min())
    assert reach > 0.05
    assert not makes_ball(grasp, limit, length, Fraction(reach))
    assert makes_ball(grasp, limit, length, Fraction(0.95 * reach))
