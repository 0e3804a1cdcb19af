"""Fingers on smooth outlines: against sampled placements, and what bounds parts of curves against points."""

import json
from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import combinations
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from regrasp.planning.placement.levels import climbing, moving_search
from regrasp.planning.placement.levels.climbing import improved
from regrasp.planning.placement.reachable import sides_of
from regrasp.verification.placed.cubic import CubicEdges

pytestmark = pytest.mark.oracle

TILTED = rg.LoadSet.hull(
    [rg.Wrench([0, -1], 0.2), rg.Wrench([0, -1], -0.2), rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1])]
)
ELLIPSE = rg.Outline.ellipse(2, 1, centre=(3, -1))
PEAR = rg.Outline.smooth([[0, 0], [1.4, -0.5], [2.1, 0.4], [1.1, 0.8], [0.7, 1.7], [-0.3, 1.2]])


@cache
def chosen(name: str, objective: str = "peak") -> rg.ChosenGrasp:
    shape = {"ellipse": ELLIPSE, "pear": PEAR}[name]
    limit = {"max_force": 3.0} if objective in ("friction_use", "angle") else {}
    return rg.choose_grasp(shape, 2, TILTED, friction=0.4, objective=objective, **limit)  # type: ignore[arg-type]


def worst(grasp: rg.Grasp, objective: str) -> float:
    """The value of a grasp: more is worse, infinite where it does not hold."""
    assert TILTED.vertices is not None
    limit = 3.0 if objective in ("friction_use", "angle") else None
    sign = -1 if objective == "angle" else 1
    try:
        return max(
            sign * rg.choose_state(grasp, rg.Wrench.from_vector(w), objective, max_force=limit).value
            for w in TILTED.vertices
        )
    except rg.Infeasible:
        return np.inf


@pytest.mark.parametrize(
    "objective", ["sum_normal", "peak_normal", "peak", "effort", "friction_use", "angle"]
)
@pytest.mark.parametrize("name", ["ellipse", "pear"])
def test_no_sampled_placement_is_better(name: str, objective: str) -> None:
    found = chosen(name, objective)
    contacts = [found.shape.contact_at(s, friction=0.4) for s in found.shape.sample(16)]
    sampled = min(worst(rg.Grasp(pair), objective) for pair in combinations(contacts, 2))
    sign = -1 if objective == "angle" else 1
    assert sign * found.bound <= sign * found.value <= sampled + 1e-3 * abs(sampled)
    assert worst(found.grasp, objective) == pytest.approx(sign * found.value, rel=1e-6, abs=1e-9)
    for contact, s in zip(found.grasp, found.places, strict=True):
        again = found.shape.contact_at(s, friction=0.4)
        assert again.position == pytest.approx(contact.position, abs=1e-11)
        assert again.normal == pytest.approx(contact.normal, abs=1e-10)


def test_no_placement_nearby_is_better() -> None:
    found = chosen("pear", "sum_normal")
    assert found.gap <= 1e-3
    off = np.random.default_rng(3).normal(scale=0.02 * PEAR.length, size=(100, 2))
    near = [[PEAR.contact_at(s, friction=0.4) for s in found.places + d] for d in off]
    values = [worst(rg.Grasp(pair), "sum_normal") for pair in near]
    assert found.bound <= min(values) < 1.1 * found.value


def test_three_fingers_and_their_proof_from_plain_data() -> None:
    found = rg.choose_grasp(PEAR, 3, TILTED, friction=0.4, objective="effort", tolerance=0.02)
    again = rg.ChosenGrasp.from_dict(json.loads(json.dumps(found.to_dict())))
    assert again == found
    verdict = rg.verify(again)
    assert verdict.ok, verdict
    assert verdict.bound == found.bound <= found.value


def test_a_proof_with_another_curve_proves_nothing() -> None:
    found = chosen("pear")
    assert rg.verify(found).ok
    control = found.certificate.control
    assert control is not None
    for spoiled in (control + 0.01, np.roll(control, 1, axis=0), control[:, ::-1]):
        proof = replace(found.certificate, control=spoiled)
        assert not rg.verify(replace(found, certificate=proof)).ok
    straight = replace(found.certificate, control=None)
    assert not rg.verify(replace(found, certificate=straight)).ok
    polygon = replace(found, shape=rg.Outline(PEAR.polygon()))
    assert not rg.verify(polygon).ok


def test_a_part_that_turns_by_a_quarter_is_none() -> None:
    proof = chosen("ellipse").certificate
    assert proof.control is not None
    halves = np.array([[[2.0, 0], [2, 1.3], [0, 1.3], [0, 0]], [[0.0, 0], [0, -1.3], [2, -1.3], [2, 0]]])
    spoiled = replace(
        proof, control=halves, vertices=halves[:, 0], centre_of_mass=np.zeros(2),
        sides=np.array([[0, 0, 1], [1, 1, 2.0]]),
    )  # fmt: skip
    assert "side 0" in str(rg.verify(spoiled))


@pytest.mark.parametrize("size", ["normal", "force"])
def test_what_bounds_a_part_is_reached_by_no_force_and_nearly_by_some(size: str) -> None:
    """On random parts of random cubics: never below what points make, and less above on shorter parts."""
    rng = np.random.default_rng(5 if size == "force" else 6)
    proof = chosen("pear").certificate
    for _ in range(40):
        legs = rng.uniform(0.3, 1, (3, 1)) * np.stack([np.ones(3), rng.uniform(-0.15, 0.15, 3)], axis=1)
        control = np.vstack([rng.normal(size=2), legs]).cumsum(axis=0)
        mu = float(rng.choice([0.0, 0.3, 1.0, 10.0]))
        edges = CubicEdges(
            replace(proof, control=control[None], friction=mu, size=size, centre_of_mass=np.zeros(2))
        )
        y, lo = rng.normal(size=3), float(rng.uniform(0, 0.9))
        hi = lo + float(rng.uniform(0.01, 1 - lo))
        given = [Fraction(c) for c in y.tolist()]
        bound = edges.most(0, Fraction(lo), Fraction(hi), given)
        made = max(_made(control, t, mu, size, y) for t in np.linspace(lo, hi, 101))
        assert float(bound) >= made * (1 - 1e-12)
        rough = edges.roughly(np.zeros(1, int), np.array([lo]), np.array([hi]), np.array([y], float))[0]
        assert rough == pytest.approx(float(bound), rel=1e-9, abs=1e-12)
        short = edges.most(0, Fraction(lo), Fraction(lo) + Fraction(1, 10**9), given)
        assert float(short) == pytest.approx(_made(control, lo, mu, size, y), rel=1e-6, abs=1e-7)


def _made(control: np.ndarray, t: float, mu: float, size: str, y: np.ndarray) -> float:
    """The most work of a force of size 1 at one point: over the edges of its cone, and along v within it."""
    b = np.array([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
    p = b @ control
    d = np.array([(1 - t) ** 2, 2 * t * (1 - t), t**2]) @ np.diff(control, axis=0)
    d /= np.hypot(*d)
    n = np.array([-d[1], d[0]])
    v = np.array([y[0] - y[2] * p[1], y[1] + y[2] * p[0]])
    forces = [n + mu * d, n - mu * d]
    if size == "force":
        forces = [f / np.hypot(*f) for f in forces]
        if abs(v @ d) <= mu * (v @ n):
            forces.append(v / np.hypot(*v))
    return max(0.0, *(float(v @ f) for f in forces))


@pytest.mark.parametrize("shape", [ELLIPSE, PEAR])
def test_cubics_are_the_outline(shape: rg.Outline) -> None:
    control = shape.cubics()
    assert control is not None
    assert control[:, 3] == pytest.approx(np.roll(control[:, 0], -1, axis=0), abs=1e-14)
    for t in (0.0, 0.3, 0.5, 0.8):
        b = np.array([(1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3])
        for point in (b[:, None] * control[::7]).sum(axis=1):
            there = shape.points(shape.nearest(point + shape.centre_of_mass))
            assert np.hypot(*(there - point)) < 1e-12
    assert rg.Outline([[0, 0], [1, 0], [0, 1]]).cubics() is None


@pytest.mark.parametrize("shape", [ELLIPSE, PEAR])
def test_arcs_of_a_curve_are_kept_to_and_may_run_past_its_start(shape: rg.Outline) -> None:
    a, b = 0.92 * shape.length, 0.06 * shape.length
    c, d = 0.4 * shape.length, 0.6 * shape.length
    found = rg.choose_grasp(shape, 2, TILTED, friction=0.8, arcs=[(a, b), (c, d)])
    inside = [s >= a - 1e-9 or s <= b + 1e-9 or c - 1e-9 <= s <= d + 1e-9 for s in found.places]
    assert all(inside)
    assert found.value >= rg.choose_grasp(shape, 2, TILTED, friction=0.8).bound
    assert rg.verify(found).ok
    assert "of the outline that was asked about" in str(rg.verify(found))


def test_units_and_turns_change_nothing() -> None:
    base = chosen("pear", "sum_normal")
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    assert TILTED.vertices is not None
    boundary = np.array([[0, 0], [1.4, -0.5], [2.1, 0.4], [1.1, 0.8], [0.7, 1.7], [-0.3, 1.2]])
    for scale in (1e-4, 1e5):
        moved = rg.Outline.smooth(np.roll(boundary[::-1], 2, axis=0) @ turn.T * scale + [3 * scale, scale])
        loads = np.column_stack([TILTED.vertices[:, :2] @ turn.T, TILTED.vertices[:, 2] * scale])
        hull = rg.LoadSet.hull(rg.Wrench.from_vector(w) for w in loads)
        found = rg.choose_grasp(moved, 2, hull, friction=0.4)
        assert found.value == pytest.approx(base.value, rel=1e-3)
        assert found.bound <= base.value * (1 + 1e-9)
        assert base.bound <= found.value * (1 + 1e-9)


def test_a_search_ends_where_no_friction_is_needed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Normals on the line of the load: a use of 0, which every level beyond it is, too."""
    calls = iter(range(100))

    def counted(*given: Any) -> Any:
        assert next(calls, None) is not None, "the best placement was found again and again"
        return improved(*given)

    for module in (climbing, moving_search):
        monkeypatch.setattr(module, "improved", counted)
    drop = rg.Outline.smooth([[0.9, 0], [0, 1.2], [-1.3, 0], [0, -1.1]])
    asked: dict[str, Any] = {"objective": "friction_use", "max_force": 10, "most_boxes": 200}
    found = rg.choose_grasp(drop, 2, rg.Wrench([1.2, 0], 0.15), friction=0.5, **asked)
    assert next(calls) > 0  # it is this search that found it
    assert found.value < 1e-5
    assert str(found.bound) == "0.0"
    assert rg.verify(found).ok


def test_three_fingers_that_need_no_friction_are_found_to_the_last() -> None:
    """Normals through the centre of mass: simplexes a thousandth of the boundary wide had ended before."""
    t = np.arange(16) * np.pi / 8
    rng = np.random.default_rng(1)
    waves = [0.3 / (j + 1) * rng.normal() * np.cos(j * t + rng.uniform(0, 6)) for j in (2, 3, 4)]
    radii = 1 + sum(waves)
    blob = rg.Outline.smooth(radii[:, None] * np.stack([np.cos(t), np.sin(t)], axis=1))
    around = rg.LoadSet.hull([rg.Wrench([np.cos(a), np.sin(a)]) for a in np.arange(6) * np.pi / 3 + 0.2])
    asked: dict[str, Any] = {"objective": "friction_use", "max_force": 4, "most_boxes": 6000}
    found = rg.choose_grasp(blob, 3, around, friction=0.5, **asked)
    assert found.value <= 2e-6
    assert found.bound == 0
    assert rg.verify(found).ok


@pytest.mark.parametrize("radius", [0.6, 2.0])
def test_round_tips_touch_nothing_else(radius: float) -> None:
    """Against distances of the tip's centre to points of the curve, which closes in on itself in a mouth."""
    t = np.linspace(0.6, 2 * np.pi - 0.6, 14)
    ring = [
        *(1.0 * np.stack([np.cos(t), np.sin(t)], axis=1)),
        *(0.55 * np.stack([np.cos(t), np.sin(t)], axis=1))[::-1],
    ]
    mouth = rg.Outline.smooth(ring)
    sides = sides_of(mouth, 0.0, None, radius)
    points = mouth.points(np.linspace(0, mouth.length, 6001))
    seen = set()
    for s in np.linspace(0.01, mouth.length, 300, endpoint=False):
        reach = np.hypot(*(points - (mouth.points(s) - radius * mouth.normals(s))).T).min()
        u = sides.u_at(float(s))
        allowed = bool(((sides.ends[:, 0] <= u) & (u <= sides.ends[:, 1])).any())
        if abs(reach / radius - 1) > 1e-3 or allowed:
            assert allowed == (reach >= radius * (1 - 1e-3))
        seen.add(allowed)
    assert seen == {True, False}
    found = rg.choose_grasp(mouth, 2, TILTED, friction=0.6, tip_radius=radius, tolerance=0.05)
    for contact in found.grasp:
        centre = contact.position - radius * contact.normal
        assert np.hypot(*(points - centre).T).min() >= radius * (1 - 1e-3)
    assert rg.verify(found).ok
