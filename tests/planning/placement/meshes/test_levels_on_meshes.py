"""Levels on meshes: what is found is shown, what is proven stands, and no sampled placement is beyond it."""

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg

pytestmark = pytest.mark.oracle
BOX = rg.Mesh.box(0.04, 0.03, 0.05)
LOADS = [
    rg.Wrench([0, 0, -2]),
    rg.Wrench([0.3, 0.9, -1]),
    rg.Wrench([0, -1, -1], [0.005, 0, 0]),
]
SIDEWAYS = rg.LoadSet.hull([rg.Wrench([0.3, 0.9, 0]), rg.Wrench([0, -1, 0.5], [0.005, 0, 0])])


@cache
def chosen(objective: str, **options) -> rg.ChosenGrasp:
    given = {"friction": 0.6, "max_force": 5.0, "tolerance": 0.05} | options
    if objective == "answered":
        return rg.choose_grasp(BOX, 3, LOADS[0], objective=objective, disturbance=SIDEWAYS, **given)
    return rg.choose_grasp(BOX, 3, rg.LoadSet.hull(LOADS), objective=objective, **given)


def sampled(count: int) -> list[rg.Grasp]:
    """All triples of points on the faces."""
    rng, (points, faces) = np.random.default_rng(0), BOX.surface()
    corners = points[faces][rng.integers(len(faces), size=count)]
    normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 1] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    at = np.einsum("ij,ijk->ik", rng.dirichlet(np.ones(3), count), corners)
    return [
        rg.Grasp(rg.Contact(at[i], normals[i], 0.6) for i in few) for few in combinations(range(count), 3)
    ]


def held(grasp: rg.Grasp, load: rg.Wrench) -> bool:
    try:
        rg.choose_state(grasp, load, "peak", max_force=5.0)
    except rg.Infeasible:
        return False
    return True


@pytest.mark.parametrize("objective", ["friction_use", "angle"])
def test_no_sampled_placement_is_beyond_the_bound_of_friction(objective: str) -> None:
    found, seen = chosen(objective), 0
    assert found.gap <= 0.05
    assert rg.verify(found).ok
    for grasp in sampled(12):
        try:
            values = [rg.choose_state(grasp, load, objective, max_force=5.0).value for load in LOADS]
        except rg.RegraspError:
            continue
        seen += 1
        if objective == "angle":
            assert min(values) <= found.bound
        else:
            assert max(values) >= found.bound
    assert seen > 10


@pytest.mark.parametrize("objective", ["friction_use", "angle", "answered"])
def test_what_is_touched_in_the_proof_of_a_level_is_seen(objective: str) -> None:
    found = chosen(objective)
    assert rg.verify(found).bound == found.bound
    halfway = found.bound + 0.5 * (found.value - found.bound)
    assert not rg.verify(replace(found, bound=halfway)).ok
    proof = found.certificate
    wider = replace(proof, friction=1.2 * proof.friction)
    assert not rg.verify(replace(found, certificate=wider)).ok
    assert not rg.verify(replace(found, certificate=replace(proof, loads=0.5 * proof.loads))).ok
    assert not rg.verify(replace(found, certificate=replace(proof, twists=-proof.twists))).ok
    assert not rg.verify(replace(found, max_force=6.0)).ok
    assert rg.verify(rg.ChosenGrasp.from_dict(found.to_dict())).ok


def test_deviations_scaled_beyond_the_bound_of_answered_are_held_by_no_sampled_placement() -> None:
    found = chosen("answered")
    assert found.gap <= 0.05
    beyond = [rg.Wrench.from_vector(LOADS[0].vector + 1.001 * found.bound * d) for d in SIDEWAYS.vertices]
    for grasp in sampled(12):
        assert not all(held(grasp, load) for load in [LOADS[0], *beyond])


def test_levels_that_no_placement_reaches_are_proven_to_have_none() -> None:
    with pytest.raises(rg.Infeasible, match="no 3 fingers anywhere on this mesh hold the loads") as none:
        chosen("friction_use", max_force=0.3)
    assert rg.verify(none.value.certificate).ok


@pytest.mark.parametrize(
    ("fingers", "load"), [(3, rg.Wrench([0, 1, -1])), (2, rg.Wrench([0, 0, -1], [0.005, 0, 0]))]
)
def test_a_search_ends_where_loads_in_one_plane_need_no_friction(fingers: int, load: rg.Wrench) -> None:
    both = rg.LoadSet.hull([LOADS[0], load])
    found = rg.choose_grasp(
        BOX, fingers, both, friction=0.6, objective="friction_use", max_force=5.0, tolerance=0.05
    )
    assert found.bound == 0.0
    assert found.value < 1e-6
    assert rg.verify(found).ok
