"""What inner pyramids cost against exact cones, objective by objective."""

import json
from itertools import pairwise
from math import isnan

import numpy as np
import pytest

import regrasp as rg
from places import TESTS
from space import best_by_cvxpy, nose_cone, random_grasp, random_load, random_rotation, rotated

pytestmark = pytest.mark.oracle

GOLDEN = json.loads((TESTS / "golden_space.json").read_text())["nose_cone_grasp"]
NOSE, DOWN = nose_cone(GOLDEN["n"], GOLDEN["friction"]), rg.Wrench([0, 0, -1.0])
PLANAR = rg.Grasp(
    rg.Contact(position, normal, 0.3)
    for position, normal in (([-4, -4], [1, 1]), ([4, -5], [-1, 2]), ([0, 8], [0, -1]))
)
PAIR = rg.Grasp([rg.Contact([-1, 0, 0], [1, 0, 0], 0.5), rg.Contact([1, 0, 0], [-1, 0, 0], 0.5)])
BETWEEN = rg.Wrench([0, -1.0, -1.0])  # half-way between two vertices of four, which lie along y and z


def test_the_published_bracket():
    lost = rg.pyramid_losses(NOSE, DOWN, "peak_normal", (4,), reserve=0.0)
    assert lost.exact == pytest.approx(GOLDEN["minimum_peak_normal_force"], abs=1e-7)
    assert lost.values[4] == pytest.approx(GOLDEN["pyramid"]["inner"], abs=1e-7)
    assert lost.losses[4] == pytest.approx(lost.values[4] / lost.exact - 1)


@pytest.mark.parametrize("objective", ["angle", "force", "effort", "peak", "peak_normal", "friction_use"])
def test_pyramids_never_gain_and_close(objective):
    lost = rg.pyramid_losses(NOSE, DOWN, objective, (4, 8, 64))
    assert lost.exact == pytest.approx(rg.choose_state(NOSE, DOWN, objective).value, rel=1e-9)
    assert min(lost.losses.values()) >= -1e-6
    assert lost.losses[64] < min(0.01, lost.losses[4])
    assert lost.lost == ()


@pytest.mark.parametrize("seed", range(6))
def test_values_agree_with_cvxpy(seed):
    rng = np.random.default_rng(seed)
    grasp, load = random_grasp(rng, 5, 0.7), random_load(rng)
    for objective in ("effort", "peak_normal"):
        lost = rg.pyramid_losses(grasp, load, objective, (4, 8, 16))
        assert lost.exact == pytest.approx(best_by_cvxpy(grasp, load, objective), rel=1e-6)
        for m, value in lost.values.items():
            want = best_by_cvxpy(grasp, load, objective, m)
            assert (isnan(value) and want == np.inf) or value == pytest.approx(want, rel=1e-6)
        if not lost.lost:  # the vertices of a polygon are among those of the next
            assert all(a >= b - 1e-8 for a, b in pairwise(lost.losses.values()))


def test_a_load_between_two_vertices_costs_the_cosine():
    lost = rg.pyramid_losses(PAIR, BETWEEN, "peak_normal", (4, 6, 8), reserve=0.0)
    assert lost.exact == pytest.approx(np.sqrt(2))
    assert lost.losses[4] == pytest.approx(np.sqrt(2) - 1, rel=1e-6)  # 1 / cos(pi / 4) - 1
    assert lost.losses[8] == pytest.approx(0.0, abs=1e-6)  # eight have a vertex there


def test_what_a_pyramid_does_not_hold_at_all_is_said():
    limit = 1.01 * rg.choose_state(PAIR, BETWEEN, "peak").value
    lost = rg.pyramid_losses(PAIR, BETWEEN, "effort", (4, 64), max_force=limit)
    assert lost.lost == (4,)
    assert isnan(lost.values[4])
    assert isnan(lost.losses[4])
    assert "     4 facets  does not hold\n" in str(lost)
    table = lost.to_dataframe()
    assert table.columns.tolist() == ["facets", "holds", "value", "loss"]
    assert table.holds.tolist() == [False, True]
    assert table.loss[1] == lost.losses[64]


def test_reads_well():
    lost = rg.pyramid_losses(NOSE, DOWN, "peak_normal", (4, 64))
    first, second, third = str(lost).splitlines()
    assert first == "peak_normal 0.491089 N with exact cones; with inner pyramids:"
    assert second == f"     4 facets  {lost.values[4]:<12.6g} {lost.losses[4]:.3%} worse"
    assert third.startswith("    64 facets  0.49")
    assert "- with exact" not in str(rg.pyramid_losses(NOSE, DOWN, "friction_use", (8,)))


def test_in_the_plane_cones_have_no_loss():
    load = rg.Wrench([-1.5, -3.5])
    for objective in ("effort", "peak_normal"):
        lost = rg.pyramid_losses(PLANAR, load, objective)
        assert max(lost.losses.values()) == pytest.approx(0.0, abs=1e-6)
    round_ = rg.pyramid_losses(PLANAR, load, "peak", (4, 32))
    assert round_.losses[4] > 0.1 > round_.losses[32] >= 0
    assert str(round_).endswith("in the plane two half-planes are the cone: facets stand for |f| = r only")


@pytest.mark.parametrize(("length", "force"), [(1e-6, 1e6), (1e6, 1e-6)])
def test_units_change_nothing_and_frames_the_pyramids_only(length, force):
    here = rg.pyramid_losses(NOSE, DOWN, "peak_normal", (4, 8))
    scaled = rg.pyramid_losses(rotated(NOSE, np.eye(3), length), DOWN * force, "peak_normal", (4, 8))
    assert scaled.exact == pytest.approx(force * here.exact, rel=1e-7)
    assert list(scaled.losses.values()) == pytest.approx(list(here.losses.values()), rel=1e-5)
    turn = random_rotation(np.random.default_rng(1))
    turned = rg.pyramid_losses(
        rotated(NOSE, turn).subset([4, 2, 0, 1, 3]), rg.Wrench(turn @ DOWN.force), "peak_normal", (4,)
    )
    assert turned.exact == pytest.approx(here.exact, rel=1e-7)
    assert turned.losses[4] != pytest.approx(here.losses[4], rel=1e-3)


def test_soft_fingers_have_no_pyramids():
    soft = rg.Grasp(c.changed(torsion=0.1) for c in NOSE)
    with pytest.raises(rg.InvalidInput, match="leave them out with soft fingers"):
        rg.pyramid_losses(soft, DOWN)


def test_what_nobody_holds_is_infeasible():
    with pytest.raises(rg.Infeasible, match="the object escapes"):
        rg.pyramid_losses(nose_cone(3, 0.05), rg.Wrench([0, 0, 1.0]))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"facets": ()}, "facets must be whole numbers, such as"),
        ({"facets": 8}, "facets must be whole numbers, such as"),
        ({"facets": (4, 2)}, "at least 3, got 2"),
        ({"facets": (None,)}, "at least 3, got None"),
        ({"objective": "best"}, "objective must be one of"),
        ({"max_force": 0}, "max_force must be greater than 0"),
    ],
)
def test_bad_input_is_named(arguments, said):
    with pytest.raises(rg.InvalidInput, match=said):
        rg.pyramid_losses(NOSE, DOWN, **arguments)
