"""What a chosen grasp or regions claim besides their proof: places, others, shares, factors, widths."""

from dataclasses import replace
from functools import cache
from math import inf, nan

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.placed.arc_lengths import points_at
from regrasp.verification.placed.meshes.areas import share_of
from regrasp.verification.placed.meshes.surfaces import touches
from regrasp.verification.placed.touching import Touching

pytestmark = pytest.mark.contract

SQUARE = rg.Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
BOX = rg.Mesh.box(0.04, 0.03, 0.05)
LOAD = rg.Wrench([0, -1.0], 0.1)
PUSHES = rg.LoadSet.hull([rg.Wrench([1, 0]), rg.Wrench([-1, 0]), rg.Wrench([0, 0], 0.3)])
OPTIONS = {
    "friction_use": {"max_force": 4.0}, "angle": {"max_force": 4.0},
    "wrench_ball": {"max_force": 2.0, "length": 1.5}, "answered": {"max_force": 5.0, "disturbance": PUSHES},
}  # fmt: skip
LARGEST = ("angle", "answered", "wrench_ball")


@cache
def chosen(objective: str = "peak", fingers: int = 2) -> rg.ChosenGrasp:
    load = rg.Wrench([0, 0]) if objective == "wrench_ball" else LOAD
    return rg.choose_grasp(
        SQUARE, fingers, load, friction=0.5, objective=objective, tolerance=0.5, **OPTIONS.get(objective, {})
    )


@cache
def on_box() -> rg.ChosenGrasp:
    return rg.choose_grasp(BOX, 3, rg.Wrench([0, 0, -2]), friction=0.5, objective="peak", tolerance=0.3)


def said(value) -> str:
    return "; ".join(rg.verify(value).violations)


OBJECTIVES = (
    "sum_normal",
    "peak_normal",
    "peak",
    "effort",
    "friction_use",
    "angle",
    "answered",
    "wrench_ball",
)


@pytest.mark.parametrize("objective", OBJECTIVES[:6])
def test_values_and_bounds_at_their_limits(objective) -> None:
    _at_their_limits(objective)


@pytest.mark.parametrize("objective", OBJECTIVES[6:])
def test_values_and_bounds_of_sets_of_loads_at_their_limits(objective) -> None:
    _at_their_limits(objective)


def _at_their_limits(objective) -> None:
    good = chosen(objective)
    assert said(good) == ""
    way = -1 if objective in LARGEST else 1  # a better value is smaller, or larger
    step = 1e-8 * (1 + abs(good.bound))
    assert said(replace(good, bound=good.bound - way * step)) == ""  # a weaker claim
    for better in (step, 0.1):
        assert said(replace(good, bound=good.bound + way * better)) != ""
    assert said(replace(good, bound=good.value + way * step)).startswith("bound ")
    for wrong in (nan, inf, -inf):
        assert said(replace(good, bound=wrong)) != ""
        assert said(replace(good, value=wrong)) != ""
    tighter = replace(good, value=good.value - way * 2e-8 * (1 + abs(good.value)))
    assert said(tighter) != ""
    assert said(replace(good, objective="least")) == "objective 'least' has no bound"
    assert "no state shows the value" in said(replace(good, states=())) or objective == "wrench_ball"
    other = next(o for o in OBJECTIVES if o != objective)
    if (objective, other) != ("peak", "friction_use"):
        assert said(replace(good, objective=other)) != ""


@pytest.mark.parametrize("objective", OBJECTIVES[:7])
def test_limits_on_forces_at_their_limits(objective) -> None:
    good = chosen(objective)
    most = max(float(np.linalg.norm(s.forces, axis=1).max()) for s in good.states)
    least = min(float((s.forces * s.grasp.normals).sum(axis=1).min()) for s in good.states)
    if objective in OBJECTIVES[:4]:
        assert said(replace(good, max_force=most * (1 + 1e-12))) == ""
        assert "above the limit" in said(replace(good, max_force=most * (1 - 1e-8)))
    else:
        assert "above the limit" in said(replace(good, max_force=most * (1 - 1e-8)))
        for limit in (None, 0.0, nan, inf):
            assert said(replace(good, max_force=limit)) != ""
    assert said(replace(good, min_normal=least)) == ""
    assert "pushes with less" in said(replace(good, min_normal=least * (1 + 1e-8) + 1e-300))


def test_states_are_of_the_contacts_and_hold() -> None:
    good = chosen("peak")
    (state,) = good.states
    moved = rg.Grasp(c.changed(friction=0.6) for c in state.grasp)
    foreign = rg.GraspState(moved, state.load, state.forces)
    assert "state 2 is of other contacts" in said(replace(good, states=(state, foreign)))
    pulled = rg.GraspState(state.grasp, state.load, -state.forces)
    assert "state 2: not in equilibrium" in said(replace(good, states=(state, pulled)))
    verdict = rg.verify(replace(good, states=(state, pulled)))
    assert verdict.worst_residual > 0.1
    assert verdict.least_angle < 0
    assert verdict.excluded == good.certificate.leaves
    assert verdict.bound == good.bound


@pytest.mark.parametrize("make", [chosen, on_box])
def test_contacts_are_at_their_places(make) -> None:
    good = make()
    places = np.array(good.places)
    size = np.abs(good.grasp.positions).max()
    for k in range(len(places)):
        for off, fine in (1e-12, True), (-1e-12, True), (3e-9, False), (-3e-9, False):
            other = places.copy()
            other[k] += off * size
            found = said(replace(good, places=other))
            assert (found == "") == fine, (k, off)
            assert fine or "off its place" in found
    assert "each contact needs a place" in said(replace(good, places=places[:-1]))
    assert "off its place" in said(replace(good, places=places * nan))
    if places.ndim == 1:
        assert said(replace(good, places=places + 8.0)) == ""  # once around


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_contacts_are_on_the_boundary_to_a_part_of_its_size(scale) -> None:
    shape = rg.Outline(scale * np.array([[0, 0], [2, 0], [2, 2], [0, 2]]))
    good = rg.choose_grasp(shape, 2, rg.Wrench([0, -1.0]), friction=0.5, objective="peak", tolerance=0.5)
    touching = Touching(good.certificate)
    assert touching.reach == pytest.approx(scale * np.sqrt(2))
    for contact in good.grasp:
        for off, fine in (0.9, True), (-0.9, True), (1.1, False), (-1.1, False):
            step = off * 2.0**-40 * touching.reach * contact.normal
            assert (rg.Contact(contact.position + step, contact.normal, 0.5) in touching) == fine, off
        for turn, fine in (3e-12, True), (-3e-12, True), (4e-12, False), (np.pi, False):
            c, s = np.cos(turn), np.sin(turn)
            normal = np.array([[c, -s], [s, c]]) @ contact.normal
            assert (rg.Contact(contact.position, normal, 0.5) in touching) == fine, turn


def test_soft_fingers_hold_more_than_proofs_are_about() -> None:
    good = on_box()
    soft = rg.Grasp([replace(c, torsion=0.01) for c in good.grasp])
    states = tuple(rg.choose_state(soft, s.load, "peak") for s in good.states)
    for changes in {"grasp": soft}, {"grasp": soft, "states": states}:
        assert (
            said(replace(good, **changes)) == "contact F1 is a soft finger, proofs are about point contacts"
        )


def test_the_distance_that_a_proof_counts_on_is_said() -> None:
    """A proof about fingers far apart says nothing of others, but for those so near that they are one."""
    for good, extent in (chosen(), 2.0), (on_box(), 0.05):
        for part, shown in (0.0, False), (0.99e-5, False), (1.01e-5, True), (0.1, True):
            proof = replace(good.certificate, min_distance=part * extent)
            words = f", fingers {part * extent:.6g} apart or more, is better than"
            for found in proof, replace(good, certificate=proof):
                assert (words in str(rg.verify(found))) == shown
                assert ("apart" in str(rg.verify(found))) == shown


def test_contacts_are_on_the_faces_that_were_asked_about() -> None:
    """Beside the triangles, in their plane, near the edge of the box; and off them."""
    good = on_box()
    proof = good.certificate
    for contact in good.grasp:
        assert touches(proof, contact)
        n = np.asarray(contact.normal)
        for axis in np.eye(3)[np.abs(n) < 0.5]:
            far = contact.position * (1 - np.abs(axis)) + 0.999 * axis * np.abs(BOX.surface()[0]).max(axis=0)
            assert not touches(proof, rg.Contact(far, n, 0.5))
        reach = float(np.linalg.norm(proof.corners, axis=2).max())
        for off, fine in (0.9, True), (1.1, False):
            moved = contact.position + off * 2.0**-40 * reach * n
            assert touches(proof, rg.Contact(moved, n, 0.5)) == fine
        assert not touches(proof, rg.Contact(contact.position, -n, 0.5))


def test_fingers_in_holes_are_at_their_places() -> None:
    ring = [[0.5, 0.5], [0.5, 1.5], [1.5, 1.5], [1.5, 0.5]]
    shape = rg.Outline([[0, 0], [2, 0], [2, 2], [0, 2]], holes=[ring])
    good = rg.choose_grasp(
        shape, 2, rg.Wrench([0, -1.0]), friction=0.5, objective="peak", tolerance=0.5, in_holes=True
    )
    assert said(good) == ""
    rings = np.asarray(good.certificate.rings)
    assert rings.tolist() == [0, 4]
    assert said(replace(good, places=np.array(good.places) + 12.0)) == ""  # once around both
    assert "off its place" in said(replace(good, places=np.array(good.places) + 8.0))
    assert said(replace(good, certificate=replace(good.certificate, rings=np.array([0, 5])))) != ""


def test_contacts_on_curves_are_at_their_places() -> None:
    for shape in rg.Outline.ellipse(2, 1), rg.Outline.smooth([[3, 0], [0, 2], [-2, 0], [0, -3]]):
        s = np.linspace(-1, 2 * shape.length, 23)
        control = shape.cubics()
        assert np.abs(points_at(s, shape.polygon(), control) - shape.points(s)).max() < 1e-11
    s = np.linspace(-3, 20, 29)
    assert np.abs(points_at(s, SQUARE.polygon(), None) - SQUARE.points(s)).max() < 1e-14


def test_a_factor_is_bounded_by_that_of_the_loads_of_the_proof() -> None:
    good = chosen("answered")
    assert said(replace(good, bound=2 * good.bound)) == ""
    loads = np.array(good.certificate.loads)
    for change in (loads[:-1], loads * 1.01, loads + np.array([0, 1e-6, 0])):
        assert said(replace(good, certificate=replace(good.certificate, loads=change))) != ""
    assert said(replace(good, deviations=0 * good.deviations)) != ""


def test_a_share_of_a_surface_counts_every_place_once() -> None:
    vertices, faces = BOX.surface()
    t = vertices[faces]
    cross = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])
    inward = -cross / np.linalg.norm(cross, axis=1)[:, None]
    whole = float(np.linalg.norm(cross, axis=1).sum() / 2)

    def share(corners, normals=inward) -> float:
        return share_of(np.array(corners), normals[: len(corners)], vertices, faces)

    assert share(t) == pytest.approx(1, rel=1e-12)
    first = float(np.linalg.norm(cross[0]) / 2 / whole)
    assert share(t[:1]) == pytest.approx(first, rel=1e-12)
    away = t - 100  # the size of numbers counts, whatever their sign
    assert share_of(away, inward, vertices - 100, faces) == pytest.approx(1, rel=1e-12)
    assert share([t[0], t[0]], inward[[0, 0]]) == -1  # twice
    small = t[0].mean(axis=0) + 0.25 * (t[0] - t[0].mean(axis=0))
    assert share([small]) == pytest.approx(first / 16, rel=1e-9)
    assert share([small, small + 0.1 * (t[0, 1] - t[0, 0])], inward[[0, 0]]) == -1  # over one another
    apart = [t[0, k] + 0.25 * (t[0] - t[0, k]) for k in range(3)]
    assert share(apart, inward[[0, 0, 0]]) == pytest.approx(3 * first / 16, rel=1e-9)
    for factor in (2.5, 1.5, 1.001):
        assert share([t[0, 0] + factor * (t[0] - t[0, 0])]) == -1  # beyond the face
    assert share([small + 1e-6 * inward[0]]) == -1  # beside its plane
    assert share([small], -inward[:1]) == -1
    tilted = small.copy()
    tilted[0] += 1e-8 * inward[0]
    assert share([tilted]) == -1
    tilted[1] -= 1e-8 * inward[0]  # about its centre, which stays
    assert share([tilted]) == -1
    assert share([0.5 * (tilted + small)]) == -1
    mate = next(j for j in range(1, len(t)) if np.allclose(inward[j], inward[0]))
    both = np.concatenate([t[0], t[mate]])
    u = np.unique(both.round(9), axis=0)
    assert share([[u[0], u[1], u.mean(axis=0)]]) == -1 or len(u) == 4  # across two faces of one plane
    middle = np.array([u[0] * 0.6 + 0.4 * u.mean(axis=0), *(0.5 * (u.mean(axis=0) + v) for v in u[1:3])])
    assert share([middle]) > 0


def test_a_proof_that_counts_a_face_twice_is_about_another_mesh() -> None:
    good = on_box()
    proof = good.certificate
    corners, normals = np.array(proof.corners), np.array(proof.normals)
    corners[1], normals[1] = corners[0], normals[0]
    twice = replace(good, certificate=replace(proof, corners=corners, normals=normals))
    assert "the proof is about another mesh" in said(twice)


@cache
def regions() -> rg.ContactRegions:
    grasp = rg.Grasp(SQUARE.contact_at(s, friction=0.5) for s in (0.9, 3.2, 6.6))
    return rg.contact_regions(SQUARE, grasp, rg.Wrench([0.1, -1.0]))


def test_regions_are_as_wide_as_they_say_about_places_that_are_the_contacts() -> None:
    good = regions()
    assert said(good) == ""
    assert said(replace(good, half_width=0.9 * good.half_width)) == ""
    for width in (good.half_width * (1 + 1e-7), inf, nan, -1e-300):
        assert "is less than the half width" in said(replace(good, half_width=width)), width
    for k in range(3):
        for off, fine in (1e-14, True), (1e-9, False), (-1e-9, False):
            places = np.array(good.places)
            places[k] += off
            found = said(replace(good, places=places))
            assert (found == "") == fine, (k, off)
            assert fine or f"contact {k + 1} is not at its place" in found
    for places in (good.places[:2], good.arcs, good.places[:, None]):
        assert "a place for each finger" in said(replace(good, places=places))
    for arcs in (good.arcs[:2], good.places, good.arcs[:, :1]):
        assert "a place for each finger" in said(replace(good, arcs=arcs))
    around = replace(good, places=good.places + 8.0, arcs=good.arcs + 8.0)
    assert said(around) == ""


def test_arcs_of_regions_are_on_one_side_and_their_corners_hold() -> None:
    good = regions()
    arcs = np.array(good.arcs)
    for k in range(3):
        for end, off in ((0, -0.5), (1, 0.5), (0, 1e-9), (1, -1e-9)):
            other = arcs.copy()
            other[k, end] += off
            assert said(replace(good, arcs=other)) != "", (k, end, off)
    assert "must not end before it begins" in said(replace(good, arcs=arcs[:, ::-1]))
    for corner in range(len(good.corners)):
        rest = [c for k, c in enumerate(good.corners) if k != corner]
        assert "1 states of corners are missing" in said(replace(good, corners=tuple(rest)))
    state = good.corners[3]
    for wrong, words in (
        (rg.GraspState(state.grasp, state.load, -state.forces), "corner state 4: not in equilibrium"),
        (
            rg.GraspState(rg.Grasp(c.changed(friction=0.6) for c in state.grasp), state.load, state.forces),
            "missing",
        ),
        (rg.GraspState(rg.Grasp(c.changed(friction=0.4) for c in state.grasp), state.load, state.forces), ""),
    ):
        corners = [*good.corners[:3], wrong, *good.corners[4:]]
        found = said(replace(good, corners=tuple(corners)))
        assert words in found
        assert words or "missing" not in found
    most = max(float(np.hypot(*c.forces.T).max()) for c in good.corners)
    for off, fine in (2.0**-50, True), (-(2.0**-50), False):
        found = said(replace(good, max_force=most * (1 + off)))
        assert found == "" if fine else "is above" in found
    assert "is above" in said(replace(good, max_force=nan))
