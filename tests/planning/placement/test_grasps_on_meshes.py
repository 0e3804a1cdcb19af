"""Grasps chosen on meshes, against all triples of points, random placements, and proofs that were spoiled."""

import json
from collections.abc import Callable
from dataclasses import replace
from functools import cache
from itertools import combinations
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.mesh import parts
from regrasp.mesh.clear import clear_faces
from regrasp.planning.placement.space.surface_search import SurfaceSearch

pytestmark = pytest.mark.oracle

BOX = rg.Mesh.box(0.04, 0.03, 0.05)
TURNED = rg.Mesh.extruded(rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]]), 2.0)
LOADS = rg.LoadSet.hull(
    [rg.Wrench([0, 0, -2]), rg.Wrench([1.5, 0, -1]), rg.Wrench([0, -1, -1], [0, 0.01, 0])]
)
HEAVY = rg.LoadSet.hull([rg.Wrench([0, 0, -2]), rg.Wrench([0, 1, -1], [0.2, 0, 0.3])])


@cache
def chosen(objective: str, fingers: int = 3) -> rg.ChosenGrasp:
    return rg.choose_grasp(BOX, fingers, LOADS, friction=0.5, objective=objective, tolerance=0.1)


def test_a_knifes_edge_neither_ends_a_search_nor_makes_grasps_passed_over_better_than_the_bound() -> None:
    found = rg.choose_grasp(BOX, 3, LOADS, friction=0.5, tolerance=0.01, most_boxes=8000)
    assert rg.verify(found).ok, rg.verify(found)
    assert found.gap <= 0.01  # and no placement there, which no forces reach, ends the search
    for other in found.others:
        needed = [rg.choose_state(other.grasp, state.load, "sum_normal").value for state in found.states]
        assert other.value == pytest.approx(max(needed))


@pytest.mark.parametrize("objective", ["sum_normal", "peak_normal", "peak", "effort"])
def test_no_triple_of_points_is_better_than_the_bound(objective: str) -> None:
    found = chosen(objective)
    assert found.bound <= found.value
    assert found.gap <= 0.1
    assert rg.verify(found).ok, rg.verify(found)
    best = np.inf
    contacts = BOX.contacts(12, friction=0.5)
    for three in combinations(contacts, 3):
        try:
            grasp = rg.Grasp(three)
            value = 0.0
            for w in LOADS_OF:
                value = max(value, rg.choose_state(grasp, w, objective).value)
                if value >= best:
                    break
        except rg.Infeasible:
            continue
        best = min(best, value)
    assert found.bound < best < 1.5 * found.bound  # so few points come near,


LOADS_OF = [rg.Wrench.from_vector(w) for w in np.asarray(LOADS.vertices)]


def test_more_fingers_need_no_more() -> None:
    four, three = chosen("peak", 4), chosen("peak")
    assert four.bound <= three.value
    assert rg.verify(four).ok


def test_what_was_passed_over_is_worth_what_it_says() -> None:
    found = chosen("peak")
    assert found.others
    for other in found.others:
        worst = max(rg.choose_state(other.grasp, w, "peak").value for w in LOADS_OF)
        assert worst == pytest.approx(other.value, rel=1e-3)
        assert worst >= found.bound


def test_on_many_faces_a_search_ends_after_so_many_corners(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("regrasp.planning.placement.space.choosing.MOST_LOOKS", 1000)
    loads = rg.LoadSet.hull(
        rg.Wrench([x, y, -1.8], [0.005, 0, 0]) for x, y in ((0.5, 0), (-0.5, 0), (0, 0.5), (0, -0.5))
    )
    asked: dict[str, Any] = {"friction": 0.6, "objective": "peak_normal"}
    short = rg.choose_grasp(parts.bracket(), 3, loads, **asked)
    longer = rg.choose_grasp(parts.bracket(), 3, loads, **asked, most_boxes=500)
    assert len(short.certificate.number) < len(longer.certificate.number)
    assert short.bound < short.value
    assert rg.verify(short).ok


def test_units_and_frames_change_names_only() -> None:
    found = rg.choose_grasp(TURNED, 3, HEAVY, friction=0.6, objective="peak", tolerance=0.02)
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]]) @ np.array([[1.0, 0, 0], [0, c, s], [0, -s, c]])
    length, force = 1e-3, 1e4
    moved = rg.Mesh(length * TURNED.vertices @ turn.T + 5.0, TURNED.faces[::-1])
    loads = [
        rg.Wrench(force * turn @ w[:3], force * length * turn @ w[3:]) for w in np.asarray(HEAVY.vertices)
    ]
    again = rg.choose_grasp(moved, 3, rg.LoadSet.hull(loads), friction=0.6, objective="peak", tolerance=0.02)
    assert again.bound <= force * found.value
    assert force * found.bound <= again.value
    assert rg.verify(again).ok
    assert rg.verify(found).ok


def test_faces_keep_away_from_sharp_edges_only() -> None:
    corners, normals = clear_faces(BOX, 0.002)
    assert np.linalg.norm(normals, axis=1) == pytest.approx(1)
    sides = corners[:, 1:] - corners[:, :1]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1).sum() / 2
    assert area == pytest.approx(2 * (36 * 26 + 36 * 46 + 26 * 46) * 1e-6, rel=2e-3)
    bracket = parts.bracket()  # whose holes have walls of flat strips, each beside the next
    corners, _ = clear_faces(bracket, 0.004)  # no more than half of the web is left, on strips as well
    assert not len(clear_faces(bracket, 0.1)[0])
    assert len(corners)
    whole, _ = clear_faces(bracket, 0.0)
    assert np.array_equal(whole, bracket.surface()[0][bracket.faces])


def spoiled(change: Callable[[dict[str, Any]], None]) -> rg.Verification:
    found = chosen("peak")
    proof = found.certificate
    values = {
        name: np.array(getattr(proof, name)) for name in ("boxes", "children", "number", "twists", "halves")
    }
    change(values)
    return rg.verify(replace(found, certificate=replace(proof, **values)))


def _swap(values: dict[str, Any]) -> None:
    leaf = int(np.flatnonzero(values["children"][:, 1] == 0)[0])
    values["twists"][leaf] *= -1


def _forget(values: dict[str, Any]) -> None:
    values["children"][0, 1] -= 1


def _shrink(values: dict[str, Any]) -> None:
    values["boxes"][1, -1] = values["halves"][int(values["boxes"][1, -1]), 0]


@pytest.mark.parametrize("change", [_swap, _forget, _shrink])
def test_spoiled_proofs_are_seen(change: Callable[[dict[str, Any]], None]) -> None:
    assert not spoiled(change).ok
    assert spoiled(lambda values: None).ok


def test_a_better_bound_than_proven_is_seen_and_so_is_another_mesh() -> None:
    found = chosen("peak")
    proof = found.certificate
    better = replace(found, bound=found.value, certificate=replace(proof, bound=1.01 * proof.bound))
    assert not rg.verify(better).ok
    assert not rg.verify(replace(found, shape=rg.Mesh.box(0.04, 0.03, 0.06))).ok
    plain = json.loads(json.dumps(found.to_dict()))
    assert rg.ChosenGrasp.from_dict(plain) == found
    plain["certificate"]["twists"][0][0] += 1.0
    with pytest.raises(rg.InvalidInput, match="digest"):
        rg.ChosenGrasp.from_dict(plain)


def test_where_none_holds_the_proof_says_so() -> None:
    with pytest.raises(rg.Infeasible, match="no 2 fingers anywhere on this mesh hold") as caught:
        rg.choose_grasp(BOX, 2, rg.Wrench([0, 0, -1], [0, 0, 1]), friction=0.0)
    assert rg.verify(caught.value.certificate).ok
    assert len(caught.value.certificate.number) < 1000


def test_two_fingers_that_hold_on_a_knifes_edge_alone_are_refused_as_such() -> None:
    with pytest.raises(rg.Infeasible, match="on a knife's edge alone, where rounding decides: two") as caught:
        rg.choose_grasp(rg.Mesh.box(4, 3, 5), 2, rg.Wrench([0, 0, -1.8]), friction=0.4)
    assert rg.verify(caught.value.certificate).ok
    assert caught.value.certificate.bound == pytest.approx(1.8)


def test_without_friction_or_load_nothing_is_held_beside_a_load() -> None:
    resting = rg.choose_grasp(BOX, 3, rg.Wrench([0, 0, -1]), friction=0.0, objective="peak", most_boxes=1000)
    assert resting.value == pytest.approx(1 / 3, rel=1e-4)
    assert resting.gap <= 1e-3
    idle = rg.choose_grasp(BOX, 3, rg.Wrench([0, 0, 0]), friction=0.5, objective="peak", most_boxes=1000)
    assert idle.value == idle.bound == 0
    assert len(idle.certificate.number) == 1


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"objective": "force", "max_force": 3.0}, r"objective 'force' has no bound on meshes"),
        (
            {"objective": "wrench_ball", "max_force": 3.0},
            r"objective 'wrench_ball' has no bound on meshes",
        ),
        ({"load": rg.Wrench([0, -1])}, r"the shape is in space and load in the plane; give a load in space"),
        ({"shape": rg.Mesh.sphere(1.0)}, r"a smooth mesh has no bound"),
        (
            {"tip_radius": 0.1, "max_force": 2.0},
            r"tip_radius: on outlines only, and the shape is a mesh",
        ),
        ({"removable": True}, r"removable: on outlines only, and the shape is a mesh"),
        ({"from_corners": 1.0}, r"from_corners leaves no place for a finger"),
        (
            {"load": rg.LoadSet.turned(rg.Wrench([0, 0, -1]))},
            r"in space load is a Wrench or the LoadSet.hull",
        ),
    ],
)
def test_what_is_refused(given: dict[str, Any], words: str) -> None:
    call: dict[str, Any] = {"shape": BOX, "fingers": 3, "load": rg.Wrench([0, 0, -1]), "friction": 0.5}
    assert words in str(refusal(lambda: rg.choose_grasp(**(call | given))))


def test_a_map_is_the_best_of_all_triples_through_each_point() -> None:
    found = rg.surface_map(BOX, 3, LOADS, friction=0.5, objective="peak", count=9)
    contacts = [
        rg.Contact(p, n, 0.5, name=str(i))
        for i, (p, n) in enumerate(zip(found.points, found.normals, strict=True))
    ]
    best = np.full(9, np.inf)
    for three in combinations(range(9), 3):
        try:
            grasp = rg.Grasp(contacts[i] for i in three)
            value = max(rg.choose_state(grasp, w, "peak").value for w in LOADS_OF)
        except rg.Infeasible:
            continue
        best[list(three)] = np.minimum(best[list(three)], value)
    assert found.best == pytest.approx(np.where(best < np.inf, best, np.nan), rel=0.011, nan_ok=True)
    assert found.share > 0


def test_an_interrupt_of_the_search_on_points_ends_the_search(monkeypatch: pytest.MonkeyPatch) -> None:
    run, asked = SurfaceSearch.run, dict[str, Any](friction=0.6, objective="peak_normal", tolerance=1e-6)

    def interrupted(search: SurfaceSearch, *given: Any) -> None:
        run(search, *given)
        search.interrupted = True

    monkeypatch.setattr(SurfaceSearch, "run", interrupted)
    found = rg.choose_grasp(parts.bracket(), 3, LOADS, **asked, most_boxes=100_000)
    assert len(found.certificate.number) < 2500
    assert 0 < found.bound < found.value
    assert rg.verify(found).ok
