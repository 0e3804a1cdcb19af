"""Maps of placement against the verbs that choose states and grasps, cell by cell."""

import numpy as np
import pytest

import regrasp as rg
from refusals import refusal
from regrasp.mesh import parts

pytestmark = pytest.mark.oracle

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
ELLIPSE = rg.Outline.ellipse(2, 1)
LOADS = rg.LoadSet.hull([rg.Wrench([0, -1], 0.2), rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1], -0.2)])


def value(shape: rg.Outline, s: list[float], objective: str, limit: float | None) -> float:
    """Of the worst load, by choose_state; NaN where one is not held or two fingers are at one place."""
    assert LOADS.vertices is not None
    try:
        grasp = rg.Grasp(shape.contact_at(v, friction=0.5) for v in s)
        states = [
            rg.choose_state(grasp, rg.Wrench.from_vector(w), objective, max_force=limit).value
            for w in LOADS.vertices
        ]
    except (rg.Infeasible, rg.InvalidInput):
        return np.nan
    return min(states) if objective == "angle" else max(states)


@pytest.mark.parametrize(
    ("objective", "limit"),
    [
        ("sum_normal", None),
        ("peak_normal", None),
        ("peak", None),
        ("effort", None),
        ("friction_use", 3.0),
        ("angle", 3.0),
    ],
)
@pytest.mark.parametrize("shape", [BRACKET, ELLIPSE])
def test_each_cell_is_what_a_state_there_costs(
    shape: rg.Outline, objective: str, limit: float | None
) -> None:
    found = rg.placement_map(shape, LOADS, friction=0.5, objective=objective, max_force=limit, count=12)
    assert (found.values == found.values.T)[~np.isnan(found.values)].all()
    for i, s in enumerate(found.places):
        for j, t in enumerate(found.places[:i]):
            wanted = value(shape, [s, t], objective, limit)
            assert found.values[i, j] == pytest.approx(wanted, rel=1e-5, abs=1e-6, nan_ok=True)
    assert np.isnan(np.diag(found.values)).all()


def test_the_best_cell_is_nearly_the_best_grasp_and_no_better() -> None:
    found = rg.placement_map(BRACKET, LOADS, friction=0.5, objective="peak", count=100)
    best = rg.choose_grasp(BRACKET, 2, LOADS, friction=0.5, objective="peak")
    assert best.bound <= np.nanmin(found.values) <= 1.05 * best.value
    assert found.at.size == 2
    assert np.nanmin(found.best) == np.nanmin(found.values)
    assert 0 < found.share < 1


def test_a_third_finger_beside_two() -> None:
    fixed = [2.2, 10.4]
    found = rg.placement_map(BRACKET, LOADS, friction=0.5, fixed=fixed, free=1, count=30)
    assert found.values.shape == found.best.shape == found.places.shape
    for s, cell in list(zip(found.places, found.values, strict=True))[::3]:
        assert cell == pytest.approx(value(BRACKET, [*fixed, s], "sum_normal", None), rel=1e-5, nan_ok=True)


def test_the_ball_of_each_cell_is_that_of_the_measure() -> None:
    found = rg.placement_map(
        ELLIPSE, rg.Wrench([0, 0]), friction=0.5, objective="wrench_ball", max_force=2.0, length=1.0, count=10
    )
    assert found.more
    for i, s in enumerate(found.places):
        for j, t in enumerate(found.places[:i]):
            pair = [ELLIPSE.contact_at(v, friction=0.5) for v in (s, t)]
            radius = rg.wrench_ball(pair, limit=2.0, length=1.0).radius
            if radius > 1e-6:
                assert found.values[i, j] == pytest.approx(radius, rel=1e-8)
            elif radius < 1e-12:
                assert np.isnan(found.values[i, j])


def test_rounding_holds_nothing() -> None:
    """Two fingers side by side on one edge hold no ball of loads, wherever on it they are."""
    found = rg.placement_map(
        BRACKET, rg.Wrench([0, 0]), friction=0.4, objective="wrench_ball", max_force=1.0, count=60
    )
    below = found.places < 4
    assert np.isnan(found.values[np.ix_(below, below)]).all()
    assert 0 < found.share < 0.15


def test_maps_of_other_numbers_of_fingers_are_refused() -> None:
    for given, words in (
        ({"free": 1}, "two to four fingers make a map: got 0 in fixed and 1"),
        ({"fixed": [0.1, 0.2, 0.3]}, "two to four fingers"),
        ({"count": 5000}, "placements; give fewer"),
        ({"fixed": [float("nan")]}, "fixed"),
        ({"fixed": [100.0]}, "fixed must be arc lengths of the outer boundary, 0 to 14; got [100.0]"),
        ({"fixed": [-0.1]}, "fixed must be arc lengths of the outer boundary"),
    ):
        said = refusal(lambda given=given: rg.placement_map(BRACKET, LOADS, friction=0.5, **given))  # type: ignore[misc]
        assert words in str(said)


def test_a_map_of_a_mesh_names_the_verb_for_it() -> None:
    said = refusal(lambda: rg.placement_map(parts.bracket(), rg.Wrench([0, -1]), friction=0.5))  # type: ignore[arg-type]
    assert "must be an Outline (surface_map is for meshes)" in str(said)
