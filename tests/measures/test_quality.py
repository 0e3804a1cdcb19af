"""Every measure against a computation of its own, and what units, frames and degenerate grasps do to it."""

from math import cos, inf, pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

import regrasp as rg
from invariance import Frame, frames
from space import nose_cone, random_grasp, random_rotation, rotated

pytestmark = pytest.mark.oracle

PLANAR = (
    "least_singular_value",
    "ellipsoid_volume",
    "isotropy",
    "polygon_shape",
    "polygon_area",
    "centroid_distance",
    "wrench_ball_Linf",
    "wrench_ball_L1",
    "decoupled_force",
    "decoupled_torque",
    "wrench_volume",
    "min_weight",
)


def ring(seed: int, count: int) -> rg.Grasp:
    rng = np.random.default_rng(seed)
    contacts = []
    for i in range(count):
        a = 2 * pi * i / count + 0.2 * rng.normal()
        b = a + pi + 0.3 * rng.normal()
        contacts.append(rg.Contact([2 * cos(a), 3 * sin(a)], [cos(b), sin(b)], rng.uniform(0.2, 0.9)))
    return rg.Grasp(contacts)


def edges(grasp: rg.Grasp, length: float) -> np.ndarray:
    """(3, 2n) wrenches of n +- mu t, torques divided by ``length``."""
    columns = []
    for c in grasp:
        t = np.array([-c.normal[1], c.normal[0]])
        for f in (c.normal - c.friction * t, c.normal + c.friction * t):
            columns.append([*f, (c.position[0] * f[1] - c.position[1] * f[0]) / length])
    return np.array(columns).T


def test_matrix_measures_are_of_the_matrix() -> None:
    """From G G', written out: no singular value is taken."""
    for seed in range(5):
        grasp = ring(seed, 4)
        x, y = grasp.positions.T / 1.7
        square = np.array([[4, 0, -y.sum()], [0, 4, x.sum()], [-y.sum(), x.sum(), (x * x + y * y).sum()]])
        values = np.linalg.eigvalsh(square)
        table = rg.quality(grasp, length=1.7)
        assert table["least_singular_value"].value == pytest.approx(sqrt(values[0]))
        assert table["ellipsoid_volume"].value == pytest.approx(sqrt(np.linalg.det(square)))
        assert table["isotropy"].value == pytest.approx(sqrt(values[0] / values[2]))


def test_contacts_without_friction_transmit_their_normal_only() -> None:
    """Four frictionless fingers along the axes through the centre: no torque, so the least value is 0."""
    grasp = rg.Grasp(rg.Contact(p, [-p[0], -p[1]], 0.0) for p in ([1, 0], [0, 1], [-1, 0], [0, -1]))
    assert rg.quality(grasp)["least_singular_value"].value == 0
    assert rg.quality(grasp)["isotropy"].value == 0


def test_polygons() -> None:
    """Regular: 0. The Roa-Suarez extreme, a triangle that is a line: 1. Angles and areas by hand."""
    regular = rg.Grasp(
        rg.Contact([cos(a) + 3, sin(a)], [-cos(a), -sin(a)], 0.3)
        for a in 2 * pi * np.array([0, 2, 4, 1, 3]) / 5
    )
    table = rg.quality(regular)
    assert table["polygon_shape"].value == pytest.approx(0, abs=1e-12)
    assert table["polygon_area"].value == pytest.approx(5 / 2 * sin(2 * pi / 5))
    assert table["centroid_distance"].value == pytest.approx(3)
    flat = rg.Grasp(rg.Contact([x, 1e-9 * x * x], [0, 1], 0.3) for x in (-1, 0, 1))
    assert rg.quality(flat)["polygon_shape"].value == pytest.approx(1, abs=1e-6)
    right = rg.Grasp(rg.Contact(p, [1, 1], 0.3) for p in ([0, 0], [3, 0], [0, 4]))
    angles = np.degrees([pi / 2, np.arctan2(4, 3), np.arctan2(3, 4)])
    assert rg.quality(right)["polygon_shape"].value == pytest.approx(abs(angles - 60).sum() / 240)
    assert rg.quality(right)["polygon_area"].value == pytest.approx(6)


def test_polygons_in_space_are_of_contacts_in_a_plane() -> None:
    rng = np.random.default_rng(0)
    spin = random_rotation(rng)
    square = [[1, 1, 0.5], [-1, -1, 0.5], [-1, 1, 0.5], [1, -1, 0.5]]
    grasp = rg.Grasp(rg.Contact(spin @ np.array(p), spin @ np.array([0, 0, 1]), 0.3) for p in square)
    table = rg.quality(grasp)
    assert table["polygon_area"].value == pytest.approx(4)
    assert table["polygon_shape"].value == pytest.approx(0, abs=1e-9)
    assert table["normals_off_plane"].value == pytest.approx(0, abs=1e-9)
    assert "polygon_area" not in rg.quality(random_grasp(rng, 4))
    three = rg.Grasp(rg.Contact(2 * e, -e, 0.3) for e in np.eye(3))
    assert rg.quality(three)["normals_off_plane"].value == pytest.approx(1 / sqrt(3))


def section(grasp: rg.Grasp, direction: np.ndarray, limit: float) -> float:
    """The largest s for which fingers of normal force up to ``limit`` make the wrench s direction."""
    n = len(grasp)
    answer = linprog(
        [0] * (2 * n) + [-1],
        A_eq=np.c_[edges(grasp, 1.0), -direction],
        b_eq=np.zeros(3),
        A_ub=np.c_[np.kron(np.eye(n), np.ones(2)), np.zeros(n)],
        b_ub=np.full(n, limit),
    )
    return float(-answer.fun)


def test_decoupled_measures_are_sections() -> None:
    """The least force over all directions without torque, by a program for each; the torque to both sides."""
    for seed in range(4):
        grasp = ring(seed, 4)
        if not rg.closure(grasp):
            continue
        table = rg.quality(grasp, limit=2.0)
        least = min(section(grasp, np.array([cos(a), sin(a), 0]), 2.0) for a in np.arange(0, 2 * pi, 0.06))
        assert table["decoupled_force"].value <= least * (1 + 1e-9)
        assert table["decoupled_force"].value >= least * 0.97
        turn = min(section(grasp, np.array([0, 0, s]), 2.0) for s in (-1.0, 1.0))
        assert table["decoupled_torque"].value == pytest.approx(turn, rel=1e-9)


def test_decoupled_without_closure() -> None:
    """Frictionless, all normals through the centre: no torque is made, but forces up to a limit are."""
    for turn in (0.0, 0.4):
        spin = np.array([[cos(turn), -sin(turn)], [sin(turn), cos(turn)]])
        grasp = rg.Grasp(rg.Contact(spin @ p, -(spin @ p), 0.0) for p in np.vstack([np.eye(2), -np.eye(2)]))
        table = rg.quality(grasp, limit=3.0)
        assert table["wrench_ball_Linf"].value == 0
        assert table["decoupled_force"].value == pytest.approx(3.0)  # the square of half-side 3
        assert table["decoupled_torque"].value == pytest.approx(0.0, abs=1e-9)
    assert rg.quality(ring(0, 4).subset([0]))["decoupled_force"].value == pytest.approx(0, abs=1e-9)


def test_decoupled_in_space_lies_below_sections() -> None:
    """Forces and torques of a known direction cannot be less than the proven lower bound."""
    grasp = random_grasp(np.random.default_rng(11), 5, 0.6)
    table = rg.quality(grasp, limit=1.0)
    rng = np.random.default_rng(1)
    for name, part in (("decoupled_force", slice(3)), ("decoupled_torque", slice(3, 6))):
        least = inf
        for _ in range(25):
            direction = np.zeros(6)
            direction[part] = rng.normal(size=3)
            direction /= np.linalg.norm(direction)
            columns = []
            for c in grasp:
                a = np.linalg.svd(c.normal[None])[2][1:]
                for k in range(24):
                    f = c.normal + c.friction * (cos(pi * k / 12) * a[0] + sin(pi * k / 12) * a[1])
                    columns.append([*f, *np.cross(c.position, f)])
            answer = linprog(
                [0] * 120 + [-1],
                A_eq=np.c_[np.array(columns).T, -direction],
                b_eq=np.zeros(6),
                A_ub=np.c_[np.kron(np.eye(5), np.ones(24)), np.zeros(5)],
                b_ub=np.ones(5),
            )
            least = min(least, -answer.fun)
        lower, upper = table[name].bounds
        assert 0 < lower <= upper <= lower * 1.011
        assert lower <= least / cos(pi / 24)


def test_volume_and_least_weight() -> None:
    grasp = ring(3, 4)
    table = rg.quality(grasp, limit=2.0, length=1.3)
    w = edges(grasp, 1.3)
    assert table["wrench_volume"].value == pytest.approx(8 * ConvexHull(np.vstack([np.zeros(3), w.T])).volume)
    weight = table["min_weight"].value
    assert 0 < weight <= 1 / 8
    # its dual: min over y of max_j (y . w_j) with sum_j (max - y . w_j) = 1 is the same number
    m, k = w.shape
    dual = linprog(
        np.r_[np.zeros(m), 1],
        A_ub=np.c_[w.T, -np.ones(k)],
        b_ub=np.zeros(k),
        A_eq=[np.r_[-w.sum(axis=1), k]],
        b_eq=[1],
        bounds=[(None, None)] * (m + 1),
    )
    assert weight == pytest.approx(dual.fun, rel=1e-6)


def test_least_sum_of_normals() -> None:
    """Lobo and others 1998: a nose cone that n fingers hold by a program for the sum of normals."""
    grasp, load = ring(1, 4), rg.Wrench([0.3, -1.0], 0.1)
    edge = edges(grasp, 1.0)
    expected = linprog(np.ones(8), A_eq=edge, b_eq=-load.vector)
    assert rg.quality(grasp, load=load)["least_normal_sum"].value == pytest.approx(expected.fun, rel=1e-6)
    hopeless = rg.Grasp([rg.Contact([0, 1], [0, -1], 0.1), rg.Contact([0.1, 1], [0, -1], 0.1)])
    assert rg.quality(hopeless, load=rg.Wrench([0, -1]))["least_normal_sum"].value == inf


def test_another_origin_does_what_each_measure_says() -> None:
    grasp = ring(3, 3)
    off = rg.Grasp(rg.Contact(c.position + 0.1, c.normal, c.friction) for c in grasp)
    load = rg.Wrench([0.0, -0.1])
    tables = [rg.quality(g, length=length, load=load) for length in (None, 1.3) for g in (grasp, off)]
    for measure in tables[0]:
        by_default, moved, fixed, moved_too = (t[measure.name].value for t in tables)
        assert (moved_too != pytest.approx(fixed, rel=1e-6, abs=1e-9)) == (measure.origin == "changes it")
        assert (moved != pytest.approx(by_default, rel=1e-6, abs=1e-9)) == (measure.origin != "none")


def test_hand_measures() -> None:
    """Fingertips moved one to one: H is the pseudo-inverse of G', so its values are those of G inverted."""
    grasp = ring(2, 3)
    table = rg.quality(grasp, jacobians=[np.eye(2)] * 3)
    size = grasp.size
    g = np.array([[1, 0, -y / size, 0, 1, x / size] for x, y in grasp.positions]).reshape(-1, 3).T
    s = np.sqrt(np.linalg.eigvalsh(g @ g.T))
    assert table["hand_least_singular_value"].value == pytest.approx(1 / s[-1])
    assert table["hand_volume"].value == pytest.approx(1 / s.prod())
    assert table["hand_isotropy"].value == pytest.approx(s[0] / s[-1])
    with pytest.raises(rg.InvalidInput, match="one for each of 3 fingers"):
        rg.quality(grasp, jacobians=[np.eye(2)])


@given(st.integers(0, 2**32 - 1), st.integers(2, 6), frames)
@settings(max_examples=15, deadline=None)
def test_what_a_change_of_units_does_is_what_the_table_says(seed: int, count: int, frame: Frame) -> None:
    grasp = ring(seed, count)
    order = np.random.default_rng(seed).permutation(count)
    mine, moved = rg.quality(grasp), rg.quality(frame.grasp(grasp, order), limit=frame.force)
    powers = {"in proportion": 1, "by its square": 2}
    for a, b in zip(mine, moved, strict=True):
        assert a.name == b.name
        force = {"N": 1, "N m": 1, "N^3": 3}.get(a.unit, 0)
        factor = frame.length ** powers.get(a.length_unit, 0) * frame.force**force
        assert b.value == pytest.approx(factor * a.value, rel=1e-6, abs=1e-9 * factor)


def test_space_in_other_units() -> None:
    rng = np.random.default_rng(11)
    grasp = random_grasp(rng, 5, 0.6)
    mine, moved = rg.quality(grasp), rg.quality(rotated(grasp, random_rotation(rng), 1e3))
    for name in ("least_singular_value", "ellipsoid_volume", "isotropy", "normals_off_plane"):
        assert moved[name].value == pytest.approx(mine[name].value, rel=1e-9)
    assert moved["decoupled_torque"].bounds[0] <= 1e3 * mine["decoupled_torque"].bounds[1]
    assert moved["decoupled_torque"].bounds[1] >= 1e3 * mine["decoupled_torque"].bounds[0]


def test_every_measure_says_what_it_is() -> None:
    table = rg.quality(ring(0, 4), load=rg.Wrench([0, -1]))
    assert table.names == (*PLANAR, "least_normal_sum")
    for measure in table:
        assert measure.unit
        assert measure.formula
        assert measure.source
        assert measure.length_unit
        assert measure.better in ("larger", "smaller")
        low, _, high = measure.range.strip("[]()").partition(",")
        top = inf if "inf" in high else eval(high, {})
        assert float(low) <= float(measure) <= top + 1e-12
    rows = table.to_dataframe()
    assert list(rows["measure"]) == list(table.names)
    assert (rows["lower"] <= rows["upper"]).all()
    with pytest.raises(rg.InvalidInput, match="no measure 'size' of this grasp; it has least_singular_value"):
        table["size"]


def test_degenerate_grasps_have_a_table() -> None:
    one = rg.quality([rg.Contact([1, 0], [-1, 0], 0.0)])
    assert {m.name: m.value for m in one if m.name != "centroid_distance"} == dict.fromkeys(
        (n for n in PLANAR if n not in ("polygon_shape", "polygon_area", "centroid_distance")), 0.0
    )
    at_centre = rg.quality([rg.Contact([0, 0], [1, 0], 0.5), rg.Contact([0, 0], [-1, 0], 0.5)])
    assert at_centre.length == 1.0
    assert at_centre["wrench_ball_L1"].value == 0
    assert rg.quality(nose_cone(3, 0.5))["least_singular_value"].value > 0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"limit": -1}, "limit must be greater than 0"),
        ({"length": -1}, "length must be greater than 0"),
        ({"facets": 2}, "facets must be a whole number of at least 3"),
        ({"load": rg.Wrench([0, 0, 1])}, "planar|plane|dimension"),
    ],
)
def test_bad_input(arguments: dict, message: str) -> None:
    with pytest.raises(rg.InvalidInput, match=message):
        rg.quality(ring(0, 3), **arguments)
