"""Ferrari and Canny's ball: convex hulls and sampled directions as oracles, laws, degenerate grasps."""

from itertools import product
from math import cos, inf, pi, sin

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog, minimize
from scipy.spatial import ConvexHull, QhullError

import regrasp as rg
from invariance import Frame, frames
from space import random_grasp, random_rotation, rotated, soft_random

pytestmark = pytest.mark.oracle


def ring(rng: np.random.Generator, count: int) -> rg.Grasp:
    """Planar contacts around the centre that push roughly inwards."""
    contacts = []
    for i in range(count):
        a = 2 * pi * i / count + 0.3 * rng.normal()
        b = a + pi + 0.3 * rng.normal()
        contacts.append(rg.Contact([2 * cos(a), 3 * sin(a)], [cos(b), sin(b)], rng.uniform(0, 0.9)))
    return rg.Grasp(contacts)


def generators(grasp: rg.Grasp, length: float, facets: int = 0, size: float = 1.0) -> np.ndarray:
    """(n, k, 3 or 6) wrenches of forces n + mu t at ``facets`` points of a cone's rim, or at both edges."""
    rows = []
    for c in grasp:
        if grasp.dimension == 2:
            around = [np.array([-c.normal[1], c.normal[0]]) * s for s in (-1, 1)]
        else:
            a = np.linalg.svd(c.normal[None])[2][1:]
            around = [
                cos(2 * pi * k / facets) * a[0] + sin(2 * pi * k / facets) * a[1] for k in range(facets)
            ]
        forces = [c.normal + size * c.friction * t for t in around]
        rows.append([[*f, *torque(c.position, f) / length] for f in forces])
    return np.array(rows)


def torque(r: np.ndarray, f: np.ndarray) -> np.ndarray:
    return np.array([r[0] * f[1] - r[1] * f[0]]) if r.size == 2 else np.cross(r, f)


def inradius(points: np.ndarray) -> float:
    """Of the hull of points, about the origin; 0 where it is flat or leaves the origin out."""
    try:
        return max(0.0, float(-ConvexHull(points).equations[:, -1].max()))
    except QhullError:
        return 0.0


def hull_radius(grasp: rg.Grasp, norm: str, length: float) -> float:
    """In the plane: hulls of corners (L1), of all sums of one corner of each finger (Linf)."""
    edges = generators(grasp, length)
    corners = np.concatenate([np.zeros((len(grasp), 1, 3)), edges], axis=1)
    if norm == "L1":
        return inradius(corners.reshape(-1, 3))
    return inradius(np.array([sum(choice) for choice in product(*corners)]))


@pytest.mark.parametrize("norm", ["Linf", "L1"])
def test_planar_radius_is_that_of_the_hull(norm: str) -> None:
    rng = np.random.default_rng(0)
    positive = 0
    for _ in range(30):
        grasp = ring(rng, int(rng.integers(2, 6)))
        length = float(rng.uniform(0.3, 5))
        ball = rg.wrench_ball(grasp, limit=1.0, norm=norm, length=length)
        expected = hull_radius(grasp, norm, length)
        assert ball.radius == pytest.approx(expected, rel=1e-9, abs=1e-12)
        assert ball.bounds == (ball.radius, ball.radius)
        positive += expected > 1e-3
    assert positive > 8


def support(grasp: rg.Grasp, norm: str, u: np.ndarray, length: float) -> np.ndarray:
    """h(u) of directions (k, 6), from the definition."""
    total = []
    for c in grasp:
        v = u[:, :3] + np.cross(u[:, 3:] / length, c.position)
        along = v @ c.normal
        across = np.linalg.norm(v - along[:, None] * c.normal, axis=1)
        if c.torsion is not None:
            across = np.hypot(across, c.torsion / c.friction * (u[:, 3:] / length) @ c.normal)
        total.append(np.maximum(0, along + c.friction * across))
    return np.max(total, axis=0) if norm == "L1" else np.sum(total, axis=0)


def least_by_descent(grasp: rg.Grasp, norm: str, length: float, rng: np.random.Generator) -> float:
    """The least h(u) from many descents of scipy: an upper bound of the radius."""
    u = rng.normal(size=(20000, 6))
    u /= np.linalg.norm(u, axis=1)[:, None]
    best = np.argsort(support(grasp, norm, u, length))[:4]

    def ratio(x: np.ndarray) -> float:
        return float(support(grasp, norm, x[None], length)[0] / np.linalg.norm(x))

    return min(minimize(ratio, u[i], method="Nelder-Mead", options={"maxiter": 500}).fun for i in best)


@pytest.mark.parametrize("norm", ["Linf", "L1"])
@pytest.mark.parametrize("soft", [False, True])
def test_bounds_in_space_hold_the_least_direction(norm: str, soft: bool) -> None:
    rng = np.random.default_rng(7)
    for _ in range(2):
        grasp = random_grasp(rng, 4)
        while not rg.closure(grasp):
            grasp = soft_random(rng, 3) if soft else random_grasp(rng, 4)
        ball = rg.wrench_ball(grasp, limit=1.0, norm=norm, length=0.8, gap=0.02)
        lower, upper = ball.bounds
        assert upper == ball.radius
        assert upper * 0.98 <= lower * (1 + 1e-9)
        assert lower <= least_by_descent(grasp, norm, 0.8, rng)
        assert support(grasp, norm, -ball.direction[None], 0.8)[0] == pytest.approx(upper, rel=1e-9)


def test_bounds_in_space_against_hulls_of_pyramids() -> None:
    """A hull of inner pyramids is no larger than the upper bound, one of outer no smaller than the lower."""
    rng = np.random.default_rng(2)
    tried = 0
    while tried < 4:
        grasp = random_grasp(rng, 3, 0.8)
        ball = rg.wrench_ball(grasp, limit=1.0, norm="L1", length=1.0, gap=0.02)
        if not ball.radius:
            continue
        tried += 1
        for size, holds in ((1.0, lambda r, b: r <= b[1]), (1 / cos(pi / 9), lambda r, b: r >= b[0])):
            points = generators(grasp, 1.0, 9, size).reshape(-1, 6)
            assert holds(inradius(np.vstack([np.zeros(6), points])), ball.bounds)


@given(st.integers(0, 2**32 - 1), st.integers(2, 7))
@settings(max_examples=40, deadline=None)
def test_limits_of_each_and_of_the_sum(seed: int, count: int) -> None:
    """eps_1 <= eps_inf <= n eps_1."""
    grasp = ring(np.random.default_rng(seed), count)
    one, each = (rg.wrench_ball(grasp, limit=1.0, norm=norm).radius for norm in ("L1", "Linf"))
    assert one <= each * (1 + 1e-9)
    assert each <= count * one * (1 + 1e-9)


def least_weight(columns: np.ndarray) -> float:
    """max l with W x = 0, sum x = 1, x >= l."""
    m, k = columns.shape
    answer = linprog(
        [0] * k + [-1],
        A_eq=np.block([[columns, np.zeros((m, 1))], [np.ones(k), 0]]),
        b_eq=[0] * m + [1],
        A_ub=np.c_[-np.eye(k), np.ones(k)],
        b_ub=np.zeros(k),
        bounds=[(None, None)] * (k + 1),
    )
    return -answer.fun if answer.status == 0 else 0.0


@pytest.mark.parametrize("length", [0.01, 1.0, 30.0])
def test_the_ball_is_no_smaller_than_the_least_weight_says(length: float) -> None:
    """eps_1 >= l sigma_min(W (1 - 1 1' / N)), l the least weight over the same N generators."""
    rng = np.random.default_rng(4)
    met = 0
    for _ in range(25):
        grasp = ring(rng, 3)
        w = generators(grasp, length).reshape(-1, 3).T
        weight = least_weight(w)
        if weight <= 1e-6:
            continue
        met += 1
        bound = weight * np.linalg.svd(w - w.mean(axis=1, keepdims=True))[1][-1]
        assert rg.wrench_ball(grasp, limit=1.0, norm="L1", length=length).radius >= bound * (1 - 1e-9)
    assert met > 5


@given(st.integers(0, 2**32 - 1), frames, st.sampled_from(["Linf", "L1"]))
@settings(max_examples=25, deadline=None)
def test_units_frames_and_order_do_not_matter(seed: int, frame: Frame, norm: str) -> None:
    rng = np.random.default_rng(seed)
    grasp = ring(rng, 4)
    limits = rng.uniform(0.5, 2, 4) if norm == "Linf" else np.ones(1)
    order = rng.permutation(4)
    mine = rg.wrench_ball(grasp, limit=limits if norm == "Linf" else 1.0, norm=norm)
    moved = rg.wrench_ball(
        frame.grasp(grasp, order), limit=frame.force * (limits[order] if norm == "Linf" else 1.0), norm=norm
    )
    assert moved.radius == pytest.approx(frame.force * mine.radius, rel=1e-7, abs=1e-12 * frame.force)


def test_units_and_frames_in_space() -> None:
    rng = np.random.default_rng(11)
    grasp = random_grasp(rng, 5, 0.6)
    mine = rg.wrench_ball(grasp, limit=2.0)
    assert mine.radius > 0
    for length in (1e-6, 1e6):
        moved = rg.wrench_ball(rotated(grasp, random_rotation(rng), length), limit=2.0)
        assert moved.bounds[0] <= mine.bounds[1]
        assert moved.bounds[1] >= mine.bounds[0]


def test_the_disturbance_named_is_the_limit() -> None:
    """A load as large as the radius in the direction named is just held under the limits, 1 % more is not."""
    grasp = ring(np.random.default_rng(0), 3)
    ball = rg.wrench_ball(grasp, limit=1.0)
    edges = generators(grasp, 1.0).reshape(-1, 3).T
    each = np.kron(np.eye(3), np.ones(2))  # the sum of both edges' shares is the normal force
    for factor, held in ((0.999, True), (1.001, False)):
        load = factor * ball.disturbance.vector
        answer = linprog(np.zeros(6), A_eq=edges, b_eq=-load, A_ub=each, b_ub=np.ones(3))
        assert (answer.status == 0) == held


def test_the_search_ends_where_two_edges_of_a_cone_were_halved_for_ever() -> None:
    """A cone once became flat between two of its edges, and no gap below a half was proven in millions."""
    points = [[59, 79, -36], [43, 123, 31], [7, -20, -104], [82, -12, -74], [-110, -1, -26], [-94, -4, -98]]
    normals = [[-56, -74, 38], [-28, -94, -16], [15, 19, 97], [-69, 20, 70], [81, -6, 59], [89, 17, 42]]
    frictions = [0.91, 0.47, 0.49, 0.83, 0.5, 0.88]
    grasp = rg.Grasp(
        rg.Contact(np.array(p) / 100, n, mu, torsion=0.1)
        for p, n, mu in zip(points, normals, frictions, strict=True)
    )
    found = rg.wrench_ball(grasp, limit=1.0)
    assert 0 < found.gap <= 0.01 + 1e-9


def test_an_upper_bound_at_once() -> None:
    grasp = random_grasp(np.random.default_rng(11), 5, 0.6)
    quick, proven = rg.wrench_ball(grasp, limit=1.0, gap=inf), rg.wrench_ball(grasp, limit=1.0)
    assert quick.bounds[0] == 0
    assert proven.bounds[0] <= quick.radius <= 1.3 * proven.radius


DEGENERATE = {
    "facing without friction": [([-1, 0], [1, 0], 0), ([1, 0], [-1, 0], 0)],
    "one contact": [([-1, 0], [1, 0], 0.5)],
    "both push left": [([-1, 0], [-1, 0], 0.5), ([1, 0], [-1, 0], 0.5)],
    "two points in space": [([-1, 0, 0], [1, 0, 0], 0.5), ([1, 0, 0], [-1, 0, 0], 0.5)],
    "on a line in space": [([x, 0, 0], [0, y, 0], 0.5) for x, y in ((-1, 1), (0, -1), (1, 1))],
    "coincident": [([0, 0], [1, 0], 0.5), ([0, 0], [-1, 0], 0.5)],
}


@pytest.mark.parametrize("rows", DEGENERATE.values(), ids=DEGENERATE)
def test_without_closure_the_radius_is_zero(rows: list) -> None:
    contacts = [rg.Contact(*row) for row in rows]
    for norm in ("Linf", "L1"):
        ball = rg.wrench_ball(contacts, limit=1.0, norm=norm)
        assert (ball.radius, ball.bounds, ball.gap) == (0.0, (0.0, 0.0), 0.0)
        assert np.linalg.norm(ball.direction) == pytest.approx(1)


def test_friction_that_is_hardly_there() -> None:
    """Facing fingers of mu 1e-6: the radius is that of the hull, a millionth."""
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 1e-6), rg.Contact([1, 0], [-1, 0], 1e-6)])
    assert rg.wrench_ball(grasp, limit=1.0).radius == pytest.approx(1e-6 * 2**0.5, rel=1e-6)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"limit": 0}, "limit must be greater than 0"),
        ({"limit": [1, 2]}, r"limit must have shape \(3,\)"),
        ({"limit": [1, 1, 1], "norm": "L1"}, "limit of an L1 ball must be a number"),
        ({"limit": 1, "norm": "L2"}, "norm must be one of Linf, L1"),
        ({"limit": 1, "length": 0}, "length must be greater than 0"),
        ({"limit": 1, "gap": 0}, "gap must be greater than 0"),
    ],
)
def test_bad_input(arguments: dict, message: str) -> None:
    with pytest.raises(rg.InvalidInput, match=message):
        rg.wrench_ball(ring(np.random.default_rng(0), 3), **arguments)


def test_it_says_what_it_found() -> None:
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)])
    assert str(rg.wrench_ball(grasp, limit=1.0)).startswith("Linf wrench ball of P1, P2: radius 0.")
