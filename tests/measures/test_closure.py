"""Form and force closure: published verdicts, independent programs, exact witnesses, degenerate grasps."""

from dataclasses import replace
from fractions import Fraction
from math import cos, radians, sin

import cvxpy as cp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

import regrasp as rg
from invariance import Frame, frames
from space import random_grasp, random_rotation, rotated, soft_random

pytestmark = pytest.mark.oracle


def contact(x: float, y: float, nx: float, ny: float, mu: float = 0.0) -> rg.Contact:
    return rg.Contact([x, y], [nx, ny], mu)


def facing(mu: float) -> list[rg.Contact]:
    return [contact(-1, 0, 1, 0, mu), contact(1, 0, -1, 0, mu)]


def around(angles: list[float], turn: float = 0.0) -> list[rg.Contact]:
    """Modern Robotics, chapter 12: four frictionless contacts at the corners of a 3 x 2 rectangle."""
    corners = ((1.5, 1), (-1.5, 1), (-1.5, -1), (1.5, -1))
    return [contact(*p, cos(radians(a)), sin(radians(a))) for p, a in zip(corners, angles, strict=True)]


# MIT 6.832 (Underactuated Robotics), problem set 5 on force closure: three contacts and their normals
THREE = [((0.1, 1), (-0.1, -1.1)), ((0.3, -0.4), (-0.4, 1.1)), ((-0.7, -0.5), (0.8, 1.1))]

PUBLISHED = [
    ("MIT 6.832, problem set 5: facing, mu 0.2", facing(0.2), "force"),
    ("the same: three contacts, mu 1.5", [contact(*p, *n, 1.5) for p, n in THREE], "force"),
    ("the same: mu 1e-7", [contact(*p, *n, 1e-7) for p, n in THREE], "none"),
    ("underactuated, issue 241: both push left", [contact(x, 0, -1, 0, 0.2) for x in (-1, 1)], "none"),
    ("Modern Robotics, chapter 12", around([225, 315, 45, 135]), "form"),
    ("the same, the last normal at 154 degrees", around([225, 315, 45, 154]), "none"),
    (
        "Lynch and Park, exercise 12.7: two normals at one corner",
        [contact(0, 0, -1, 0), contact(0, 0, 0, -1), contact(0, 1, 1, 0), contact(2, 0, 0, 1)],
        "form",
    ),
    ("facing without friction", facing(0.0), "none"),
    ("facing, mu 0.5", facing(0.5), "force"),
    ("four of mu 0.3", [*facing(0.3), contact(0, 1, 0, -1, 0.3), contact(0, -1, 0, 1, 0.3)], "force"),
]


@pytest.mark.parametrize(("contacts", "kind"), [row[1:] for row in PUBLISHED], ids=[r[0] for r in PUBLISHED])
def test_published_verdicts(contacts: list[rg.Contact], kind: str) -> None:
    found = rg.closure(contacts)
    assert found.kind == kind
    assert found.strict == (kind != "none") == bool(found)
    assert found.is_proof


def test_weights_of_the_exercise() -> None:
    """Lynch and Park, exercise 12.7: the least sum of weights of at least 1 is (2, 1, 2, 1)."""
    found = rg.closure(PUBLISHED[6][1])
    assert [w / min(found.weights) for w in found.weights] == [2, 1, 2, 1]


# -- against programs written from the definition ---------------------------------------------------------


def edges(grasp: rg.Grasp) -> np.ndarray:
    """(3, 2n) wrenches of both edges of planar cones."""
    columns = []
    for c in grasp:
        (x, y), (nx, ny) = c.position, c.normal
        for f in (
            (nx - c.friction * -ny, ny - c.friction * nx),
            (nx + c.friction * -ny, ny + c.friction * nx),
        ):
            columns.append([*f, x * f[1] - y * f[0]])
    return np.array(columns).T


def planar(rng: np.random.Generator, count: int, frictions: tuple[float, ...]) -> rg.Grasp:
    points, normals = rng.normal(size=(2, count, 2))
    normals -= rng.choice([0.5, 1.5]) * points
    mu = rng.choice(frictions, count)
    return rg.Grasp(rg.Contact(*row) for row in zip(points, normals, mu, strict=True))


def margin_of(columns: np.ndarray) -> float:
    """min over |u|_inf = 1 of max_j u . w_j, side by side of the cube: > 0 exactly with closure."""
    m, k = columns.shape
    values = []
    for side in range(2 * m):
        bounds = [(-1, 1)] * m + [(None, None)]
        bounds[side // 2] = ((-1, 1)[side % 2],) * 2
        answer = linprog([0] * m + [1], A_ub=np.c_[columns.T, -np.ones(k)], b_ub=np.zeros(k), bounds=bounds)
        values.append(answer.fun)
    return min(values)


@pytest.mark.parametrize("frictions", [(0.0,), (0.0, 0.3, 1.0), (0.05, 0.2)])
def test_planar_verdicts_against_linear_programs(frictions: tuple[float, ...]) -> None:
    rng = np.random.default_rng(len(frictions))
    kinds = []
    for _ in range(40):
        grasp = planar(rng, int(rng.integers(1, 7)), frictions)
        found = rg.closure(grasp)
        assert found.is_proof
        smooth = rg.Grasp(c.changed(friction=0.0) for c in grasp)
        form, force = margin_of(edges(smooth)), margin_of(edges(grasp))
        if min(abs(form), abs(force)) > 1e-7:
            assert found.kind == ("form" if form > 0 else "force" if force > 0 else "none")
        elif force < 1e-12:
            assert found.kind == "none"
        kinds.append(found.kind)
    assert len(set(kinds)) > 1


def separation(grasp: rg.Grasp) -> float:
    """max t with n . v - mu |v_t| >= t along a twist, |y|_inf <= 1: > 0 exactly where cones separate."""
    y, t = cp.Variable(6), cp.Variable()
    rows = [cp.norm_inf(y) <= 1]
    for c in grasp:
        x, yy, z = c.position
        cross = np.array([[0, z, -yy], [-z, 0, x], [yy, -x, 0]])  # omega x r
        v = y[:3] + cross @ y[3:]
        along = c.normal @ v
        across = v - along * c.normal
        if c.torsion is not None:
            across = cp.hstack([across, c.torsion / c.friction * (c.normal @ y[3:])])
        rows.append(along - c.friction * cp.norm(across) >= t)
    problem = cp.Problem(cp.Maximize(t), rows)
    problem.solve(solver=cp.CLARABEL)
    return float(problem.value)


@pytest.mark.parametrize("soft", [False, True])
def test_verdicts_in_space_against_cone_programs(soft: bool) -> None:
    rng = np.random.default_rng(5)
    kinds = []
    for _ in range(25):
        count = int(rng.integers(2, 6))
        grasp = soft_random(rng, count) if soft else random_grasp(rng, count)
        found = rg.closure(grasp)
        assert found.is_proof
        if separation(grasp) > 1e-6:
            assert found.kind == "none"
        elif soft or count > 2:  # two point contacts leave the turn about their line free
            assert found.kind == "force"
        kinds.append(found.kind)
    assert set(kinds) == {"force", "none"}


def test_form_closure_in_space_needs_seven() -> None:
    """Of frictionless contacts on a box: six never close, seven of these do (Lakshminarayana 1978)."""
    rng = np.random.default_rng(1)
    closed = 0
    for _ in range(12):
        faces = rng.permutation(np.r_[np.arange(6), rng.integers(0, 6, 4)])
        contacts = []
        for face in faces:
            axis, side = divmod(int(face), 2)
            point = rng.uniform(-1, 1, 3)
            point[axis] = 1 if side else -1
            contacts.append(rg.Contact(point, -point[axis] * np.eye(3)[axis], 0.0))
        assert rg.closure(contacts[:6]).kind == "none"
        found = rg.closure(contacts)
        columns = np.array([[*c.normal, *np.cross(c.position, c.normal)] for c in contacts]).T
        assert found.is_proof
        assert (found.kind == "form") == (margin_of(columns) > 1e-9)
        closed += found.kind == "form"
    assert 0 < closed < 12


# -- the limit, from both sides ---------------------------------------------------------------------------


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.1, 2.9])
@pytest.mark.parametrize("change", [-1e-3, -1e-9, 0.0, 1e-9, 1e-3])
@pytest.mark.parametrize("dimension", [2, 3])
def test_the_edge_of_a_cone_along_the_line_of_two_fingers(turn: float, change: float, dimension: int) -> None:
    """Closure exactly where both cones hold the line strictly inside, however rounded (Nguyen 1988)."""
    turned = np.array([[cos(turn), -sin(turn), 0], [sin(turn), cos(turn), 0], [0, 0, 1]])[
        :dimension, :dimension
    ]
    rows = [([-1, 0, 0], [1, 1, 0]), ([1, 0, 0], [-1, 1, 0])]
    contacts = [
        rg.Contact(
            turned @ np.array(p[:dimension]),
            turned @ np.array(n[:dimension]),
            1 + change,
            torsion=0.1 if dimension == 3 else None,
        )
        for p, n in rows
    ]
    found = rg.closure(contacts)
    assert found.kind == ("force" if change > 0 else "none")
    assert found.is_proof
    assert found.strict == (change > 1e-6)


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.1])
def test_normals_through_one_point_close_nothing_however_rounded(turn: float) -> None:
    spin = np.array([[cos(turn), -sin(turn)], [sin(turn), cos(turn)]])
    grasp = rg.Grasp(
        rg.Contact(spin @ p, -(spin @ p), 0.0) for p in np.array([[1, 0], [0, 1], [-1, 0], [0, -1]])
    )
    found = rg.closure(grasp)
    assert found.kind == "none"
    assert found.is_proof
    assert abs(found.escape[2]) == pytest.approx(1)


@pytest.mark.parametrize(
    ("mu", "kind", "strict"), [(1e-7, "force", True), (1e-10, "force", False), (1e-13, "none", False)]
)
def test_friction_that_is_hardly_there(mu: float, kind: str, strict: bool) -> None:
    found = rg.closure(facing(mu))
    assert (found.kind, found.strict, found.is_proof) == (kind, strict, True)


def test_degenerate_grasps() -> None:
    one = rg.closure([contact(1, 0, -1, 0, 0.5)])
    assert (one.kind, one.is_proof) == ("none", True)
    two = rg.Grasp([rg.Contact([x, 0, 0], [-x, 0, 0], 0.5) for x in (-1, 1)])
    assert rg.closure(two).kind == "none"
    np.testing.assert_array_equal(abs(rg.closure(two).escape), [0, 0, 0, 1, 0, 0])  # about their line
    line = rg.Grasp([rg.Contact([x, x, 2 * x], [1, -1, 0], 0.5) for x in (-1.0, 0.5, 2.0)])
    assert rg.closure(line).kind == "none"
    at_centre = rg.closure([contact(0, 0, 1, 0, 0.5), contact(0, 0, -1, 0, 0.5), contact(0, 0, 0, 1)])
    assert (at_centre.kind, at_centre.is_proof) == ("none", True)


# -- laws -------------------------------------------------------------------------------------------------


@given(st.integers(0, 2**32 - 1), frames)
@settings(max_examples=25, deadline=None)
def test_kind_does_not_depend_on_units_frames_and_order(seed: int, frame: Frame) -> None:
    rng = np.random.default_rng(seed)
    grasp = planar(rng, int(rng.integers(2, 6)), (0.0, 0.3, 0.8))
    assert rg.closure(frame.grasp(grasp)).kind == rg.closure(grasp).kind


def test_kind_in_space_does_not_depend_on_units_and_frames() -> None:
    rng = np.random.default_rng(8)
    for _ in range(6):
        grasp = random_grasp(rng, 4)
        for length in (1e-6, 1e6):
            assert rg.closure(rotated(grasp, random_rotation(rng), length)).kind == rg.closure(grasp).kind


def test_room_is_survived() -> None:
    """Wrenches moved by less than ``room`` per unit force still close."""
    rng = np.random.default_rng(3)
    tried = 0
    while tried < 8:
        grasp = planar(rng, 4, (0.3, 0.8))
        found = rg.closure(grasp)
        if not found:
            continue
        tried += 1
        unit = edges(grasp) / grasp.lengths[:, None]
        unit /= np.linalg.norm(unit[:2], axis=0)
        for _ in range(10):
            change = rng.normal(size=unit.shape)
            change *= 0.999 * found.room / np.linalg.norm(change, axis=0)
            assert margin_of(unit + change) > 0


def test_a_wrong_witness_is_no_proof() -> None:
    found = rg.closure(facing(0.5))
    heavier = (found.weights[0] + Fraction(1, 10**30), *found.weights[1:])
    assert not replace(found, weights=heavier).is_proof
    assert not replace(found, weights=tuple(-w for w in found.weights)).is_proof
    outside = (
        tuple(f * Fraction(3, 2) if k else f for k, f in enumerate(found.forces[0])),
        *found.forces[1:],
    )
    assert not replace(found, forces=outside).is_proof
    flat = replace(found, contacts=(0, 1), forces=((Fraction(1), Fraction(0)), (Fraction(-1), Fraction(0))))
    assert not replace(flat, weights=(Fraction(1), Fraction(1))).is_proof  # in balance, but spans nothing
    none = rg.closure(facing(0.0))
    assert not replace(none, twist=(Fraction(1), Fraction(0), Fraction(0))).is_proof
    assert not replace(none, twist=(Fraction(0),) * 3).is_proof


def test_bad_input() -> None:
    for bad in (3, None, rg.Contact([1, 0], [1, 0], 0.2)):
        with pytest.raises(rg.InvalidInput, match="grasp must be a"):
            rg.closure(bad)
    with pytest.raises(rg.InvalidInput, match="at least one contact"):
        rg.closure([])
    with pytest.raises(rg.InvalidInput, match="one dimension"):
        rg.closure([contact(1, 0, 1, 0), rg.Contact([1, 0, 0], [1, 0, 0], 0.1)])


def test_it_says_what_it_found() -> None:
    assert str(rg.closure(facing(0.5))) == "force closure by P1, P2: survives changes of 0.22"
    assert str(rg.closure(facing(0.0))) == "no closure by P1, P2: no contact opposes the twist (0, 1, 0)"
    assert str(rg.closure(facing(1e-10))) == "force closure by P1, P2: a small change ends it"
