"""What grasps chosen for margins and sets of loads claim, at the limit of each claim; and those on meshes."""

import tracemalloc
from dataclasses import replace
from functools import cache
from math import atan, hypot, inf, nan, sin
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from regrasp.verification.placed.chosen_grasps import _check_bound
from regrasp.verification.placed.claims.contacts import _all_shown
from regrasp.verification.placed.claims.levels import _scaled, _scaled_by_less
from regrasp.verification.placed.touching import Touching

pytestmark = pytest.mark.contract

SQUARE = rg.Outline([[0, 0], [2, 0], [2, 2], [0, 2]])
BOX = rg.Mesh.box(0.04, 0.03, 0.05)
PUSHES = rg.LoadSet.hull([rg.Wrench([1, 0]), rg.Wrench([-1, 0]), rg.Wrench([0, 0], 0.3)])
OPTIONS = {
    "force": {"max_force": 4.0}, "friction_use": {"max_force": 1.0}, "angle": {"max_force": 1.0},
    "wrench_ball": {"max_force": 2.0, "length": 1.5}, "answered": {"max_force": 5.0, "disturbance": PUSHES},
}  # fmt: skip
BETTER, WRONG = "is better than what the proof says", "the proof proves no bound"


@cache
def chosen(objective: str) -> rg.ChosenGrasp:
    given = {"wrench_ball": ([0, 0], 0), "force": ([0, -3], 0.1), "answered": ([0, -1], 0.1)}
    load, tolerance = rg.Wrench(*given.get(objective, ([0, -1], 1.2))), 0.5 if objective in given else 0.1
    return rg.choose_grasp(
        SQUARE, 2, load, friction=0.5, objective=objective, tolerance=tolerance, **OPTIONS[objective]
    )


@cache
def on_box() -> rg.ChosenGrasp:
    return rg.choose_grasp(BOX, 3, rg.Wrench([0, 0, -2]), friction=0.5, objective="peak", tolerance=0.3)


def said(value) -> str:
    return "; ".join(rg.verify(value).violations)


def claimed(good) -> str:
    """What is wrong with the bound, its proof taken for one."""
    return "; ".join(_check_bound(good, good.certificate))


def with_proof(good, **changes):
    return replace(good, certificate=replace(good.certificate, **changes))


def test_a_force_margin_is_that_of_the_states_and_of_the_proof() -> None:
    good = chosen("force")
    verdict = rg.verify(good)
    assert verdict.ok
    assert verdict.least_angle == min(s.margins.least_angle for s in good.states)
    margin = min(s.margins.least_force for s in good.states)
    for value, fine in ((margin, True), (margin * (1 + 0.9e-9), True), (margin * (1 + 1.1e-9), False)):
        found = said(replace(good, value=value))
        assert (found == "") == fine
        assert fine or f"the force margin is below the value {value:.12g}" in found
    proof = good.certificate
    assert said(replace(good, bound=proof.margin)) == ""
    assert BETTER in said(replace(good, bound=np.nextafter(proof.margin, 0)))
    assert said(with_proof(good, friction=0.5)) == ""
    assert "more friction" in said(with_proof(good, friction=np.nextafter(0.5, 0)))


def test_levels_are_those_that_the_proof_excludes() -> None:
    for objective, way in ("angle", 1), ("friction_use", -1):
        good = chosen(objective)
        narrow = good.certificate.friction
        bound = atan(0.5) - atan(narrow) if way > 0 else narrow / 0.5
        for off, fine in ((1e-8, True), (0.0, True), (-1e-8, False)):
            found = said(replace(good, bound=bound + way * off))
            assert (found == "") == fine, (objective, off)
            assert fine or BETTER in found
        mixed = rg.Grasp([good.grasp[0], good.grasp[1].changed(friction=0.6)])
        assert "the contacts have several" in said(replace(good, grasp=mixed))


@pytest.mark.parametrize("objective", list(OPTIONS))
def test_values_are_understated_by_no_file(objective) -> None:
    for good in chosen(objective), on_box():
        assert said(good) == ""
        factor = 1 if good.objective in ("friction_use", "peak") else -1
        for part in (1e-6, 1.0) if factor < 0 else (1e-6, 1.0, 1e300):
            found = said(replace(good, value=good.value * (1 + factor * part)))
            assert "is worse than" in found or "the states do not hold the load" in found, part


@pytest.mark.parametrize("objective", list(OPTIONS))
def test_a_search_cut_short_proves_what_needs_no_proof(objective) -> None:
    """Forces above the limit alone are excluded by a proof of less than the limit."""
    good = chosen(objective)
    short = with_proof(good, bound=good.max_force * (1 - 1e-12))
    assert said(good) == ""
    assert WRONG in said(short)
    limit, bound = good.max_force, {
        "force": 4 * sin(atan(0.5)), "friction_use": 0.0, "angle": atan(0.5),
        "wrench_ball": 4 * hypot(1, 0.5),
    }.get(objective)  # fmt: skip
    if objective == "answered":  # a force of twice the limit, or a torque of that at the largest lever
        reach = Touching(good.certificate).reach
        center, deviations = np.asarray(good.certificate.loads)[0], np.asarray(good.deviations)
        with np.errstate(divide="ignore"):
            factors = (2 * limit * np.array([1, 1, reach]) - np.sign(deviations) * center) / np.abs(
                deviations
            )
        bound = float(factors[deviations != 0].min())
    step = 1e-6 * (1 + bound)
    if objective == "friction_use":
        best = replace(short, value=0.0, bound=bound)
        assert WRONG not in said(best)
        assert "is above the value" in said(replace(best, bound=step))
    else:
        assert said(replace(short, bound=bound + step)) == ""
        assert WRONG in said(replace(short, bound=bound - step))


def test_a_ball_is_that_of_its_loads_its_length_and_its_limit() -> None:
    good = chosen("wrench_ball")
    loads = np.asarray(good.certificate.loads)
    sizes = np.linalg.norm(loads / [1, 1, 1.5], axis=1)
    assert sizes.max() <= good.bound * (1 + 1e-9)
    for k in range(len(loads)):
        larger = loads.copy()
        larger[k] *= good.bound / sizes[k] * (1 + 2e-9)
        assert BETTER in claimed(with_proof(good, loads=larger)), k
    for length in (None, 0.0, -1.0, inf, nan):
        assert "a ball of loads needs a length" in claimed(replace(good, length=length))
    for value in (good.value * (1 + 1e-9), -1e-300):
        assert "do not make all wrenches" in claimed(replace(good, value=value))
    for length in (1.4, 1.6):  # other lengths are other balls
        assert claimed(replace(good, length=length)) != ""
    assert claimed(replace(good, value=0.5 * good.value)) == ""
    a, b = good.grasp
    across = a.position - b.position
    for push, fine in ((1.9, True), (2.1, False)):
        f = push * np.array([a.normal, -np.asarray(a.normal)])
        state = rg.GraspState(good.grasp, rg.Wrench([0, 0]), f)
        found = said(replace(good, states=(state,)))
        if abs(across @ a.normal) > 0.999 * np.hypot(*across):
            assert ("a force of 2.1 is above the limit 2" in found) != fine


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("arm", [1e-6, 1.0, 1e9])
def test_loads_are_the_deviations_by_a_factor_at_every_scale(scale, arm) -> None:
    """To a billionth, of the largest force and of the largest torque: neither loosens the other."""
    units = scale * np.array([1, 1, arm])
    center, deviations = units * [0.5, -2.0, 1.0], units * [[1.0, 0, 0], [0, -1, 0.5]]
    given = SimpleNamespace(certificate=SimpleNamespace(loads=[center]), deviations=deviations)
    loads = center + 3 * deviations
    size = units * [5, 5, 2.5]
    for at in np.ndindex(2, 3):
        for off, fine in ((0.9e-9, True), (-0.9e-9, True), (1.1e-9, False), (-1.1e-9, False)):
            other = loads.copy()
            other[at] += off * size[at[1]]
            assert _scaled(given, other, 3.0) == fine, (at, off)
    assert not _scaled(given, loads[:1], 3.0)
    assert not _scaled(given, loads, 3.1)
    whole = np.array([center, *loads])
    for factor, fine in ((3.0, True), (4.0, True), (3 * (1 - 0.9e-9), True), (3 * (1 - 1.1e-9), False)):
        assert _scaled_by_less(given, whole, factor) == fine
    assert not _scaled_by_less(given, whole[:2], 3.0)
    for times, fine in ((0.0, True), (1e-300, True), (-1e-9, False), (-1.0, False)):  # on the other side
        others = np.array([center, *(center + times * deviations)])
        assert _scaled_by_less(given, others, 3.0) == fine, times
    none = SimpleNamespace(certificate=given.certificate, deviations=0 * deviations)
    assert not _scaled_by_less(none, np.array([center, center, center]), 3.0)


def test_what_is_lost_on_the_other_side_bounds_no_answer() -> None:
    """A floor of fingers answers nine times as much weight, and no lift of more than the weight."""
    floor, weight = [[0.1, 1.9]], rg.Wrench([0, -1])
    given = {"friction": 0.5, "objective": "answered", "max_force": 5.0, "tolerance": 0.1, "arcs": floor}
    lifts = {y: rg.LoadSet.hull([rg.Wrench([0, y]), rg.Wrench([0, y], -0.01 * y)]) for y in (-1, 1)}
    down, up = (rg.choose_grasp(SQUARE, 2, weight, disturbance=lifts[y], **given) for y in (-1, 1))
    assert down.value > 8
    assert up.bound < 1.2
    deviations, value = -up.deviations, 1.0
    loads = [weight, *(rg.Wrench([0, -1 + value * y], value * turn) for _, y, turn in deviations)]
    states = tuple(rg.choose_state(up.grasp, load, "peak") for load in loads)
    lie = replace(up, states=states, deviations=deviations, value=value, bound=1.2, others=())
    assert BETTER in said(lie)
    backwards = replace(up, deviations=deviations, value=-up.value, bound=-up.value)
    assert "answered by 0 times or more" in said(backwards)


def test_of_loads_in_space_forces_and_torques_have_units_of_their_own() -> None:
    """No force where all are torques, however large; and each to its own size, also where a row is 0."""
    turn, push = np.array([[0, 0, 0, 0, 0, 1e12]]), np.array([[0, 0, 2.0, 0, 0, 1e12]])
    for row in range(6):
        for load, off, fine in (
            (turn, 0.0, True), (push, 0.0, True), (turn, 1e-3 if row < 3 else 1.1e3, False),
            (turn, 900, row > 2),
            (push, 1.9e-9, True), (push, 2.1e-9, row > 2), (push, 1.1e3, False),
        ):  # fmt: skip
            given = SimpleNamespace(certificate=SimpleNamespace(loads=np.zeros((1, 6))), deviations=load)
            other = load.copy()
            other[0, row] += off
            assert _scaled(given, other, 1.0) == fine, (row, off)
            states = [SimpleNamespace(load=SimpleNamespace(vector=w)) for w in other]
            assert _all_shown(SimpleNamespace(states=states), load) == fine, (row, off)


@pytest.mark.parametrize("arm", [1e-6, 1.0, 1e6])
def test_loads_are_shown_where_they_lie_between_those_of_states(arm) -> None:
    """To a billionth, of forces and of torques each by its own size."""
    one, other = np.array([1.0, -2.0, 0.5 * arm]), np.array([-1.0, -2.0, 1.0 * arm])
    states = [SimpleNamespace(load=SimpleNamespace(vector=w)) for w in (one, other)]
    size = np.array([1.0, 2.0, arm])
    for share in (0.0, 0.3, 1.0):
        between = one + share * (other - one)
        for k in range(3):
            for off, fine in ((0.0, True), (0.5e-9, True), (-0.5e-9, True), (1e-8, False), (-1e-8, False)):
                load = between.copy()
                load[k] += off * size[k]
                given = SimpleNamespace(states=states)
                assert _all_shown(given, np.array([one, load, other])) == fine, (share, k, off)
    beyond = one + 1.001 * (other - one)
    assert not _all_shown(SimpleNamespace(states=states), np.array([one, beyond]))
    assert not _all_shown(SimpleNamespace(states=states[:1]), np.array([one, other]))
    assert not _all_shown(SimpleNamespace(states=[]), np.array([one]))
    none = [SimpleNamespace(load=SimpleNamespace(vector=np.zeros(3)))]
    assert _all_shown(SimpleNamespace(states=none), np.zeros((1, 3)))
    assert not _all_shown(SimpleNamespace(states=none), np.array([[0, 0, 1e-300]]))


def test_slacks_and_shares_are_told() -> None:
    for good in (chosen("angle"), on_box()):
        verdict = rg.verify(good)
        assert verdict.least_cone_slack < inf
        assert verdict.least_cone_slack == min(
            rg.verify(replace(good, states=(s,))).least_cone_slack for s in good.states
        )
    proof = on_box().certificate
    corners = np.asarray(proof.corners)
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    share = areas.sum() / 4 / (0.04 * 0.03 + 0.03 * 0.05 + 0.05 * 0.04)
    assert 0.9 < share < 0.999
    assert rg.verify(on_box()).asked == f" on the {share:.1%} of the surface that was asked about"


def test_what_a_grasp_on_a_mesh_claims() -> None:
    good = replace(on_box(), others=())
    assert said(good) == ""
    proof, grasp = good.certificate, good.grasp
    (state,) = good.states
    other = rg.GraspState(state.grasp, 1.001 * state.load, 1.001 * state.forces)
    assert "a load of the proof has no state" in said(replace(good, states=(other,)))
    for goal in ("force", "wrench", "wrench_ball"):
        assert "has no bound on meshes" in said(replace(good, objective=goal, max_force=4.0))
    assert "the proof is about another mesh" in said(replace(good, shape=SQUARE))
    assert "the proof is about another mesh" in said(replace(good, shape=rg.Mesh.box(0.041, 0.03, 0.05)))
    pair = rg.Grasp(list(grasp)[:2])
    two = replace(good, grasp=pair, states=(), places=np.asarray(good.places)[:2])
    assert "the proof is about 3 fingers, the grasp has 2" in said(two)
    rough = rg.Grasp(c.changed(friction=np.nextafter(0.5, 1)) for c in grasp)
    slick = rg.Grasp(c.changed(friction=0.4) for c in grasp)
    assert said(replace(good, grasp=rough)).count("has more friction than the proof is about") == 3
    assert "more friction" not in said(replace(good, grasp=slick))
    p = grasp.positions
    least = min(float(np.linalg.norm(p[i] - p[j])) for i in range(3) for j in range(i))
    rounding = 2.0**-40 * np.abs(p).max()
    for off, fine in ((0.0, True), (0.99 * rounding, True), (1.01 * rounding, False)):
        found = said(replace(good, certificate=replace(proof, min_distance=least + off)))
        assert ("two contacts are nearer than the least distance" in found) != fine
    away = [
        rg.Contact(1.1 * c.position, c.normal, 0.5, name=c.name) if i == 1 else c for i, c in enumerate(grasp)
    ]
    moved = said(replace(good, grasp=rg.Grasp(away)))
    assert f"contact {away[1].name} is on none of the faces" in moved
    assert moved.count("is on none of the faces") == 1


def test_what_a_grasp_on_an_outline_claims() -> None:
    good = rg.choose_grasp(
        SQUARE, 2, rg.Wrench([0, -1.0], 0.1), friction=0.5, objective="peak", tolerance=0.5
    )
    (state,) = good.states
    other = rg.GraspState(state.grasp, 1.001 * state.load, 1.001 * state.forces)
    assert "a load of the proof has no state" in said(replace(good, states=(other,)))
    away = float(np.hypot(*(good.grasp[0].position - good.grasp[1].position)))
    rounding = 2.0**-40 * 2**0.5  # of the corner's distance
    for off, fine in ((0.0, True), (0.99 * rounding, True), (1.01 * rounding, False)):
        found = said(with_proof(good, min_distance=away + off))
        assert ("two contacts are nearer than the least distance" in found) != fine
    rough = rg.Grasp(c.changed(friction=np.nextafter(0.5, 1)) for c in good.grasp)
    assert said(replace(good, grasp=rough)).count("has more friction than the proof is about") == 2
    three = rg.Grasp([*good.grasp, rg.Contact([0.5, -1], [0, 1], 0.5)])
    assert "the proof is about 2 fingers, the grasp has 3" in said(replace(good, grasp=three))
    for shape in (rg.Outline([[0, 0], [2, 0], [2, 2.001], [0, 2]]), rg.Outline.ellipse(2, 1)):
        assert "the proof is about another" in said(replace(good, shape=shape))


def test_proofs_of_chosen_grasps_are_checked_and_places_are_of_the_mesh() -> None:
    good = replace(on_box(), others=())
    shape = SimpleNamespace(surface=BOX.surface, centre_of_mass=np.array([0.1, -0.2, 0.3]))
    assert said(replace(good, shape=shape, places=np.asarray(good.places) + shape.centre_of_mass)) == ""
    flat = rg.choose_grasp(
        SQUARE, 2, rg.Wrench([0, -1.0], 0.1), friction=0.5, objective="peak", tolerance=0.5
    )
    for grasp in good, flat:
        assert rg.verify(grasp).worst_residual < 1e-9
        assert "does not exclude" in said(with_proof(grasp, twists=-np.asarray(grasp.certificate.twists)))
        state = grasp.states[0]
        rough = rg.Grasp(c.changed(friction=0.6) for c in state.grasp)
        foreign, pulled = (rg.GraspState(g, state.load, -state.forces) for g in (rough, state.grasp))
        found = said(replace(grasp, states=(foreign, pulled, *grasp.states)))
        assert "state 1 is of other contacts" in found
        assert "state 2: not in equilibrium" in found


def test_loads_between_those_of_thousands_of_states_take_little_memory() -> None:
    """All pairs at once would be 3 GB for each array of them."""
    angles = np.arange(4000) * 2 * np.pi / 4000
    loads = np.stack([np.cos(angles), np.sin(angles), 0.1 + 0 * angles], axis=1)
    given = SimpleNamespace(states=[SimpleNamespace(load=SimpleNamespace(vector=load)) for load in loads])
    middle = 0.3 * loads[7] + 0.7 * loads[3001]
    tracemalloc.start()
    try:
        assert _all_shown(given, np.array([*loads[::100], middle]))
        assert not _all_shown(given, np.array([1.01 * loads[0], loads[5]]))
        assert tracemalloc.get_traced_memory()[1] < 50e6
    finally:
        tracemalloc.stop()
