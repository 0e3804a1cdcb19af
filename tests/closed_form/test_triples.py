"""Three fingers in space: verdicts and forces, against programs over edges and over exact cones."""

from dataclasses import replace
from math import inf, isnan, nan

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from regrasp.closed_form.three_fingers import HOLDS, LINE, NO_STATE, three_finger_hold
from regrasp.closed_form.triple import (
    COLLINEAR,
    along_squeezes,
    centroid_moment,
    particular_forces,
    rigid_motion,
    squeezed,
    triple_frame,
)
from solids import Motion, motions
from triple_programs import (
    Case,
    angle_margins,
    is_held,
    is_held_in_cones,
    least_peak,
    random_case,
    widest_angle,
)

pytestmark = pytest.mark.oracle

seeds = st.integers(0, 10**6)
facet_counts = st.sampled_from([4, 6, 8, 12, 16])


def hold(case: Case, facets: int = 8, **options):
    verdict, margin, forces = three_finger_hold(case.fingers, *case.load, facets, **options)
    return verdict, np.arctan(margin), np.array(forces)


def is_clear(case: Case, facets: int) -> bool:
    """Whether the verdict is the same with a little less and a little more friction."""
    return is_held(case.with_friction(1 - 1e-7), facets) == is_held(case.with_friction(1 + 1e-7), facets)


def residual(case: Case, forces: np.ndarray) -> float:
    """Of forces and torques, relative to the largest force and the largest arm."""
    force = forces.sum(axis=0) + case.force
    torque = np.cross(case.points, forces).sum(axis=0) + case.torque
    peak = np.linalg.norm(forces, axis=1).max()
    return max(abs(force).max(), abs(torque).max() / abs(case.points).max()) / peak


@given(seeds, motions())
def test_particular_forces_and_squeezes_balance_every_load(seed: int, motion: Motion) -> None:
    case = random_case(seed)
    points = motion.points(case.points)
    frame = triple_frame(*map(tuple, points.tolist()))
    force, torque = case.load
    torque = tuple(motion.scale * x for x in torque)
    start = particular_forces(frame, force, centroid_moment(frame, force, torque))
    for squeezes in ((0.0, 0.0, 0.0), (0.7, -0.4, 1.1)):
        forces = np.array(squeezed(frame, start, squeezes))
        assert residual(replace(case, points=points, torque=np.array(torque)), forces) < 1e-9
    k, centre = np.array(frame[0]), points.mean(axis=0)
    within = np.array(start) - np.outer(np.array(start) @ k, k)
    for pull, other in (((1, 0, 0), 1), ((0, 1, 0), 2), ((0, 0, 1), 0)):
        i = (other - 1) % 3
        along = np.array(squeezed(frame, ((0.0,) * 3,) * 3, pull))
        assert along[i] == pytest.approx(-along[other])
        assert abs(np.cross(along[i], points[other] - points[i])).max() < 1e-9 * motion.scale
        # The least sum of squares within the plane has nothing along any squeeze.
        assert abs((along * within).sum()) < 1e-9 * abs(within).max()
        assert [along_squeezes(frame, c, tuple(centre.tolist()))[i] for c in range(3)] == pytest.approx(
            (along @ centre).tolist(), abs=1e-9 * abs(centre).max()
        )


@given(seeds)
def test_a_rigid_motion_does_the_work_of_the_load(seed: int) -> None:
    case = random_case(seed)
    rng = np.random.default_rng(seed)
    v, omega = rng.normal(size=(2, 3))
    velocities = v + np.cross(omega, case.points - case.points.mean(axis=0))
    frame = triple_frame(*map(tuple, case.points.tolist()))
    assert np.ravel(rigid_motion(frame, velocities.tolist())) == pytest.approx([*v, *omega], abs=1e-7)


@given(seeds, facet_counts, st.booleans())
def test_the_verdict_is_that_of_a_program_over_the_edges(seed: int, facets: int, limited: bool) -> None:
    case = random_case(seed, limited=limited)
    verdict, margin, forces = hold(case, facets)
    if is_clear(case, facets):
        assert verdict == (HOLDS if is_held(case, facets) else NO_STATE)
    if verdict == HOLDS:
        assert residual(case, forces) < 2.0**-38
        assert angle_margins(case, forces).min() >= margin - 1e-9 >= -1e-9
        assert (np.linalg.norm(forces, axis=1) <= case.limits).all()
    else:
        assert np.isnan(forces).all()
        assert isnan(margin)


@given(seeds, st.sampled_from([4, 8]))
def test_what_a_pyramid_holds_finer_pyramids_and_the_cone_hold(seed: int, facets: int) -> None:
    case = random_case(seed)
    verdicts = [hold(case, m)[0] for m in (facets, 2 * facets, 4 * facets)]  # each lies within the next
    assert verdicts == sorted(verdicts, reverse=True)
    if verdicts[-1] == HOLDS:
        assert is_held_in_cones(case)


def test_finer_pyramids_lose_less() -> None:
    cases = [random_case(seed) for seed in range(400)]
    exact = np.array([is_held_in_cones(case) for case in cases])
    assert 60 < exact.sum() < 340
    found = [sum(hold(case, m, with_margin=False)[0] == HOLDS for case in cases) for m in (4, 8, 16, 32)]
    assert found == sorted(found)
    assert found[0] < found[-1] <= exact.sum()
    assert found[-1] > 0.98 * exact.sum()


@given(seeds, facet_counts, st.booleans(), st.sampled_from([1.0, 1.5, 3.0]))
def test_the_margin_is_that_of_narrowed_pyramids(seed: int, facets: int, limited: bool, ratio: float) -> None:
    case = random_case(seed, limited=limited)
    verdict, margin, forces = hold(case, facets, peak_ratio=ratio)
    if verdict == HOLDS and is_clear(case, facets):
        assert margin == pytest.approx(widest_angle(case, facets, ratio), abs=1e-6)
        if not limited:
            bounds = (forces * case.normals).sum(axis=1) * np.sqrt(1 + case.mu**2)
            # The friction that forces are chosen within is less by 1e-9; near a singular triple that matters.
            assert bounds.max() <= ratio * least_peak(case.with_friction(1 - 1e-9), facets) * (1 + 1e-8)


@given(seeds, motions(), st.sampled_from([1e-6, 1.0, 1e6]), st.permutations(range(3)), facet_counts)
def test_frame_units_and_order_change_nothing(
    seed: int, motion: Motion, newton: float, order: list[int], facets: int
) -> None:
    case = random_case(seed)
    other = case.moved(motion.rotation, motion.scale, newton, list(order))
    verdict, margin, _ = hold(case, facets)
    if is_clear(case, facets):
        again = hold(other, facets)
        assert again[0] == verdict
        if verdict == HOLDS:
            assert again[1] == pytest.approx(margin, abs=1e-7)
            assert residual(other, again[2]) < 2.0**-38


@given(seeds)
def test_without_a_margin_the_sum_of_normal_forces_is_least(seed: int) -> None:
    case = random_case(seed)
    verdict, _, forces = hold(case, with_margin=False)
    wide = hold(case)
    assert wide[0] == verdict
    if verdict == HOLDS:
        assert (forces * case.normals).sum() <= (wide[2] * case.normals).sum() * (1 + 1e-9)


@given(seeds, st.floats(0, 1), st.floats(1e-12, 1e-10))
def test_points_on_a_line_are_no_hold(seed: int, share: float, off: float) -> None:
    case = random_case(seed)
    a, b, _ = case.points
    on_line = a + share * (b - a) + off * np.linalg.norm(b - a) * np.array([0.6, 0.0, 0.8])
    verdict, margin, forces = hold(replace(case, points=np.array([a, b, on_line])))
    assert verdict == LINE
    assert isnan(margin)
    assert np.isnan(forces).all()


def test_one_point_is_a_line() -> None:
    case = random_case(0)
    for points in ([case.points[0]] * 3, [case.points[0], case.points[1], case.points[0]]):
        assert hold(replace(case, points=np.array(points)))[0] == LINE


def test_how_thin_a_triangle_is_knows_how_far_it_lies() -> None:
    near = np.array([[0, 0, 0], [1, 0, 0], [0.5, 1e-8, 0]])
    assert triple_frame(*map(tuple, near.tolist()))[7] > COLLINEAR
    assert triple_frame(*map(tuple, (near + 1e9).tolist()))[7] <= COLLINEAR


def upright(mu: tuple[float, float, float]) -> Case:
    """Two fingers that press a box from left and right, one that carries it from below, straight up."""
    points = np.array([[-1.0, 0, 0.1], [1.0, 0, 0.1], [0, 0, -1.0]])
    normals = np.array([[1.0, 0, 0], [-1.0, 0, 0], [0, 0, 1.0]])
    return Case(points, normals, np.array(mu), np.full(3, inf), np.array([0, 0, -2.0]), np.zeros(3))


def test_a_finger_without_friction_may_help() -> None:
    verdict, margin, forces = hold(upright((0.5, 0.5, 0.0)))
    assert verdict == HOLDS
    assert margin == 0.0  # it has no angle to spare
    assert forces[2, 2] > 0
    assert residual(upright((0.5, 0.5, 0.0)), forces) < 2.0**-40


@given(seeds)
def test_frictionless_fingers_are_never_taken_for_more(seed: int) -> None:
    case = random_case(seed)
    case = replace(case, mu=case.mu * np.array([1, 1, 0]))
    verdict, _, forces = hold(case)
    if verdict == HOLDS:
        assert residual(case, forces) < 2.0**-38
        assert is_held_in_cones(replace(case, mu=case.mu + np.array([0, 0, 1e-7])))
    elif is_held_in_cones(replace(case, mu=0.7 * case.mu)):
        pytest.fail("held with less friction at the others")


def test_three_fingers_without_friction_hold_what_points_through_them() -> None:
    case = upright((0.0, 0.0, 0.0))
    assert hold(case)[0] == HOLDS
    assert hold(replace(case, force=np.array([0, 0.1, -2.0])))[0] == NO_STATE


def test_a_grasp_in_its_own_plane_is_judged_by_the_exact_angle() -> None:
    angles = np.radians([80, 200, 330])
    points = np.c_[np.cos(angles), np.sin(angles), 0 * angles]
    for mu in (0.2, 0.35, 0.5):
        for way in np.radians(range(0, 360, 15)):
            force = np.array([np.cos(way), np.sin(way), 0])
            case = Case(points, -points, np.full(3, mu), np.full(3, inf), force, np.array([0, 0, 0.15]))
            assert (hold(case, 4)[0] == HOLDS) == is_held_in_cones(case)


def test_no_load_needs_no_force() -> None:
    case = replace(random_case(1), force=np.zeros(3), torque=np.zeros(3))
    verdict, _, forces = hold(case, with_margin=False)
    assert verdict == HOLDS
    assert not forces.any()


def test_a_verdict_without_state_has_no_forces() -> None:
    away = replace(upright((0.1, 0.1, 0.1)), force=np.array([0, 0, 9.0]))
    limited = replace(away, limits=np.full(3, 1.0))
    assert hold(limited)[0] == NO_STATE
    assert repr(hold(limited)[1]) == repr(nan) or isnan(hold(limited)[1])


def test_a_finger_that_hardly_pushes_is_no_reason_to_give_up() -> None:
    """At the least sum of normal forces one finger is all but idle, and rounding puts it off its cone."""
    points = np.array([[-0.5, -1, 0], [0.5, -1, 0], [0, 1, 0]])
    normals = np.array([[0.0, 1, 0], [0, 1, 0], [0, -1, 0]])
    case = Case(points, normals, np.ones(3), np.full(3, inf), np.array([1.0, 0, 0]), np.array([0, 0, 0.25]))
    assert is_held(case.with_friction(0.999), 8)
    for with_margin in (False, True):
        verdict, margin, forces = hold(case, with_margin=with_margin)
        assert verdict == HOLDS
        assert residual(case, forces) < 2.0**-40
    assert margin == pytest.approx(widest_angle(case, 8, 3.0), abs=1e-6)
