"""States in space: published optima, cvxpy, the plane embedded, frames, units and tangents."""

import json
from itertools import pairwise
from math import inf

import numpy as np
import pytest

import regrasp as rg
from places import TESTS
from regrasp.mechanics.orientation.spiral import even_directions
from regrasp.mechanics.orientation.tangents import tangent_pairs
from regrasp.planning.states.faces import ball_faces, cone_faces
from regrasp.planning.states.program import state_program
from regrasp.programs import solve
from space import best_by_cvxpy, nose_cone, random_grasp, random_load, random_rotation, rotated

pytestmark = pytest.mark.oracle

GOLDEN = json.loads((TESTS / "golden_space.json").read_text())["nose_cone_grasp"]
NOSE, DOWN = nose_cone(GOLDEN["n"], GOLDEN["friction"]), rg.Wrench([0, 0, -1.0])
OBJECTIVES = ("angle", "force", "effort", "peak", "peak_normal", "friction_use")
SEEDS = range(12)


@pytest.mark.parametrize(
    ("objective", "published", "within"),
    [
        ("peak_normal", GOLDEN["minimum_peak_normal_force"], 1e-7),
        ("peak", GOLDEN["minimum_peak_force"], 1e-7),
        ("effort", GOLDEN["minimum_sum_of_squares"], 1e-7),
    ],
)
@pytest.mark.parametrize("method", ["clarabel", "cvxpy:CLARABEL"])
def test_published_optima(objective, published, within, method):
    best = rg.choose_state(NOSE, DOWN, objective, method=method, reserve=0.0)
    assert best.value == pytest.approx(published, abs=within if method == "clarabel" else 1e-6)


@pytest.mark.parametrize("method", ["clarabel", "daqp", "highs", "piqp"])
def test_published_bracket_of_pyramids(method):
    inner = rg.choose_state(NOSE, DOWN, "peak_normal", method=method, facets=4, reserve=0.0)
    assert inner.value == pytest.approx(GOLDEN["pyramid"]["inner"], abs=1e-7)
    assert best_by_cvxpy(NOSE, DOWN, "peak_normal", 4, outer=True) == pytest.approx(
        GOLDEN["pyramid"]["outer"], abs=1e-6
    )


@pytest.mark.parametrize("objective", ["peak_normal", "effort"])
def test_pyramids_bracket_the_exact_cone_and_close(objective):
    exact = rg.choose_state(NOSE, DOWN, objective, reserve=0.0).value
    inner = [rg.choose_state(NOSE, DOWN, objective, facets=m, reserve=0.0).value for m in (4, 8, 16, 32, 64)]
    outer = [best_by_cvxpy(NOSE, DOWN, objective, m, outer=True) for m in (4, 8, 16, 32, 64)]
    assert min(inner) >= exact - 1e-8
    assert max(outer) <= exact + 1e-7
    assert inner[-1] - outer[-1] < 0.01 * exact
    assert all(a >= b - 1e-8 for a, b in pairwise(inner))  # each polygon's vertices are among the next one's


@pytest.mark.parametrize("seed", SEEDS)
def test_values_agree_with_cvxpy(seed):
    rng = np.random.default_rng(seed)
    grasp, load = random_grasp(rng, int(rng.integers(3, 6))), random_load(rng)
    if best_by_cvxpy(grasp, load, "effort") == inf:
        with pytest.raises(rg.Infeasible) as caught:
            rg.choose_state(grasp, load)
        assert caught.value.certificate is not None
        assert caught.value.certificate.is_proof
        return
    for objective in ("effort", "peak", "peak_normal", "force"):
        best = rg.choose_state(grasp, load, objective)
        assert best.value == pytest.approx(best_by_cvxpy(grasp, load, objective), rel=1e-6, abs=1e-7)
        assert best.residual <= 1e-13 * max(best.magnitudes.max(), 1)
        assert best.margins.least_force >= 0


def test_seeds_hold_both_verdicts():
    def held(seed):
        rng = np.random.default_rng(seed)
        return best_by_cvxpy(random_grasp(rng, int(rng.integers(3, 6))), random_load(rng), "effort") < inf

    assert {held(seed) for seed in SEEDS} == {True, False}


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize(("length", "force"), [(1.0, 1.0), (1e-6, 1e6), (1e6, 1e-6)])
def test_frames_units_and_labels_change_nothing(objective, length, force):
    rng = np.random.default_rng(7)
    turn = random_rotation(rng)
    seen = rotated(NOSE, turn, length).subset([3, 1, 4, 0, 2])
    load = rg.Wrench(force * (turn @ DOWN.force))
    best, same = rg.choose_state(NOSE, DOWN, objective), rg.choose_state(seen, load, objective)
    unit = {"angle": 1.0, "friction_use": 1.0, "effort": force**2}.get(objective, force)
    assert same.value == pytest.approx(unit * best.value, rel=2e-6)
    if objective == "effort":  # the only one whose state is unique
        assert same.forces == pytest.approx(
            force * best.forces[[3, 1, 4, 0, 2]] @ turn.T, rel=1e-5, abs=1e-6 * force
        )


def test_tangents_are_orthonormal_and_exact_answers_do_not_depend_on_them(monkeypatch):
    rng = np.random.default_rng(3)
    normals = np.vstack([rng.normal(size=(200, 3)), [[0, 0, 1], [0, 0, -1], [1e-9, 0, 1], [1, 0, 0]]])
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    frames = np.concatenate([tangent_pairs(normals), normals[:, None]], axis=1)
    identities = np.tile(np.eye(3), (len(normals), 1, 1))
    assert frames @ frames.swapaxes(1, 2) == pytest.approx(identities, abs=1e-12)
    grasp = nose_cone(4, 0.4)
    c, s = np.cos(0.7), np.sin(0.7)
    other = nose_cone(4, 0.4)
    other.__dict__["tangents"] = np.array([[c, s], [-s, c]]) @ grasp.tangents
    values = []
    for each in (grasp, other):
        program = state_program(each, DOWN, "effort", [0.4] * 4, [inf] * 4, 1.0)
        values.append(solve(program, "clarabel").value)
    assert values[0] == pytest.approx(values[1], abs=1e-7)


def test_the_plane_embedded_in_space_gives_the_planar_answers():
    places = [([-4, -4], [1, 1]), ([4, -5], [-1, 2]), ([0, 8], [0, -1])]
    planar = rg.Grasp(rg.Contact(position, normal, 0.3) for position, normal in places)
    load = rg.Wrench([-1.5, -3.5])
    space = rg.Grasp(rg.Contact([*c.position, 0], [*c.normal, 0], c.friction) for c in planar)
    seen = rg.Wrench([-1.5, -3.5, 0])
    for objective in OBJECTIVES:
        flat, best = rg.choose_state(planar, load, objective), rg.choose_state(space, seen, objective)
        assert best.value == pytest.approx(flat.value, rel=1e-6), objective
    removal, flat = (
        rg.plan_removal(space, 2, load=seen, objective="effort"),
        rg.plan_removal(planar, 2, load=load, objective="effort"),
    )
    assert removal.end.forces == pytest.approx(np.pad(flat.end.forces, ((0, 0), (0, 1))), abs=1e-6)
    out = rg.Wrench([-1.5, -3.5, 0], [0.3, 0, 0])  # out of the plane: friction takes part of it
    assert rg.choose_state(space, out, "peak").value > rg.choose_state(space, seen, "peak").value
    with pytest.raises(rg.Infeasible, match="about the line through P1 and P2") as caught:
        rg.choose_state(space.subset([0, 1]), rg.Wrench([-1.5, -3.5, 0], [1.0, -8.0, 0]), "peak")
    assert caught.value.certificate.is_proof


def test_faces_are_inside_round_sets():
    rng = np.random.default_rng(5)
    grasp = random_grasp(rng, 40)
    mu = grasp.frictions
    for facets in (3, 4, 7, 16):
        forces = rng.normal(size=(40, 4000, 3)) + 2 * grasp.normals[:, None]
        cone = np.einsum("nkd,nmd->nmk", cone_faces(grasp, mu, facets), forces).min(axis=-1) >= 0
        normal = np.einsum("nmd,nd->nm", forces, grasp.normals)
        tangential = np.linalg.norm(forces - normal[..., None] * grasp.normals[:, None], axis=-1)
        inside = tangential <= mu[:, None] * normal
        assert not (cone & ~inside).any()
        directions, cosines = ball_faces(grasp, mu, facets)
        reach = (np.einsum("nkd,nmd->nmk", directions, forces) / cosines[:, None]).max(axis=-1)
        sizes = np.linalg.norm(forces, axis=-1)
        assert (reach[inside] >= sizes[inside] * (1 - 1e-12)).all()
        if facets == 16:
            assert cone.sum() > 0.95 * inside.sum()
            assert (reach[inside] <= 1.03 * sizes[inside]).all()


def test_a_back_end_without_round_cones_asks_for_facets():
    with pytest.raises(rg.InvalidInput, match="facets"):
        rg.choose_state(NOSE, DOWN, "effort", method="daqp")


def test_force_limits_in_space():
    limited = rg.choose_state(NOSE, DOWN, "peak_normal", max_force=0.52)
    assert limited.magnitudes.max() <= 0.52
    for method, facets in (("clarabel", None), ("daqp", 16)):
        with pytest.raises(rg.Infeasible, match="the cones alone would hold it with larger forces") as caught:
            rg.choose_state(NOSE, DOWN, "peak_normal", max_force=0.50, method=method, facets=facets)
        assert caught.value.certificate.is_proof


def test_a_slide_that_no_finger_opposes():
    side = [rg.Contact([np.cos(a), np.sin(a), 0], [-np.cos(a), -np.sin(a), 0], 0.0) for a in (0.0, 2.1, 4.2)]
    with pytest.raises(rg.Infeasible, match=r"escapes by sliding along \(0, 0, -1\)") as caught:
        rg.choose_state(rg.Grasp(side), DOWN, "peak")
    assert caught.value.certificate.is_proof


def test_what_holds_only_in_the_limit_says_so():
    # Finger 1 can push along t only beside ever larger forces on an edge of its cone, which finger 2 takes.
    mu = 0.5
    edge, t = np.array([mu, 0, 1.0]) / np.hypot(mu, 1), np.array([0, 1.0, 0])
    place = np.array([0.1, 0.2, -0.3])
    grasp = rg.Grasp([rg.Contact(place, [0, 0, 1], mu), rg.Contact(place + edge, -edge, 0.0)])
    load = rg.Wrench(-t, np.cross(place, -t))
    with pytest.raises(rg.Infeasible, match="but only in the limit: forces of 100 times") as caught:
        rg.choose_state(grasp, load, "peak")
    assert caught.value.certificate is None
    a_little_more = rg.Grasp([rg.Contact(place, [0, 0, 1], 1.01 * mu), grasp[1]])
    assert rg.choose_state(a_little_more, load, "peak").residual < 1e-12


def test_two_fingers_say_which_turn_they_leave_free():
    pair = rg.Grasp([rg.Contact([-1, 0, 0], [1, 0, 0], 0.5), rg.Contact([1, 0, 0], [-1, 0, 0], 0.5)])
    assert pair.freedom == "turning about the line through P1 and P2"
    assert abs(pair.matrix.T @ pair.free_twists[0]).max() < 1e-15
    state = rg.choose_state(pair, DOWN, "effort")
    assert "no force of these contacts resists turning about the line through P1 and P2" in repr(state)
    removal = rg.plan_removal(pair.with_contact(rg.Contact([0, 1, 0], [0, -1, 0], 0.5)), 2, load=DOWN)
    assert "at the end no force of P1, P2 resists turning about the line" in str(removal)
    assert NOSE.freedom is None
    assert NOSE.subset([0]).freedom == "turning about P1"


def test_forces_many_times_the_load_are_found():
    grasp, load = random_grasp(np.random.default_rng(26), 5, 0.8), rg.Wrench(even_directions(100)[14])
    for objective in ("peak", "force", "effort"):
        assert rg.choose_state(grasp, load, objective).value == pytest.approx(
            best_by_cvxpy(grasp, load, objective), rel=1e-5
        )


def test_wider_limits_choose_no_worse_where_rounding_hides_the_best():
    """Of the angle, to a hundred-thousandth: a wide limit may add no more than that."""
    at = (-0.01861, -0.002975, 0.006628), (-0.01261, 0.003211, 0.006998), (0.04139, 0.001674, -0.01014)
    ways = (1, 0, 0), (-1, 0, 0), (-1, 0, 0)
    grasp = rg.Grasp(rg.Contact(p, normal=n, friction=0.7) for p, n in zip(at, ways, strict=True))
    for objective in ("angle", "force"):
        few = rg.choose_state(grasp, rg.Wrench([0, 0, -1.82]), objective, peak_ratio=1e3)
        for ratio in (1e6, 1e9):
            many = rg.choose_state(grasp, rg.Wrench([0, 0, -1.82]), objective, peak_ratio=ratio)
            assert many.value >= few.value - 1e-5
            assert max(many.force_limits) == pytest.approx(ratio / 1e3 * max(few.force_limits), rel=1e-3)
