"""Chosen grasps against all pairs and triples of sampled points, and against other coordinates."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from placements import BRACKET, DEVIATIONS, TILTED, star, value_of

pytestmark = pytest.mark.oracle


RING = rg.LoadSet.hull(rg.Wrench([np.cos(t), np.sin(t)]) for t in np.arange(6) * np.pi / 3)


OBJECTIVES = ("sum_normal", "peak_normal", "peak", "effort")


def sampled_best(outline: rg.Outline, fingers: int, count: int, objective: str) -> float:
    vertices = TILTED.vertices
    assert vertices is not None
    contacts = [outline.contact_at(s, friction=0.4) for s in outline.sample(count)]
    return min(value_of(rg.Grasp(few), vertices, objective) for few in combinations(contacts, fingers))


@pytest.mark.parametrize("objective", OBJECTIVES)
@pytest.mark.parametrize(
    ("outline", "fingers", "count"), [(BRACKET, 2, 14), (star(4, 9), 2, 16), (star(5, 8), 3, 8)]
)
def test_no_sampled_placement_is_better(
    outline: rg.Outline, fingers: int, count: int, objective: str
) -> None:
    chosen = rg.choose_grasp(outline, fingers, TILTED, friction=0.4, objective=objective)
    sampled = sampled_best(outline, fingers, count, objective)
    assert chosen.bound <= chosen.value <= sampled * (1 + 1e-3)
    assert chosen.gap <= 1e-3
    # and the value is that of the grasp
    vertices = TILTED.vertices
    assert vertices is not None
    assert value_of(chosen.grasp, vertices, objective) == pytest.approx(chosen.value, rel=1e-6)


def test_random_placements_of_one_box_never_beat_the_bound_of_it() -> None:
    chosen = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4)
    vertices = TILTED.vertices
    assert vertices is not None
    rng = np.random.default_rng(1)
    near = [
        [BRACKET.contact_at(s + d, friction=0.4) for s, d in zip(chosen.places, off, strict=True)]
        for off in rng.normal(scale=0.02 * BRACKET.length, size=(60, 2))
    ]
    values = [value_of(rg.Grasp(few), vertices, "sum_normal") for few in near]
    assert min(values) >= chosen.bound
    assert min(values) < 1.2 * chosen.value  # they are placements that compete


def test_one_load_on_given_edges_is_exact_at_once() -> None:
    """Fact 10: under one load a finger on an edge is a line contact, so values meet bounds."""
    chosen = rg.choose_grasp(star(7, 12), 3, rg.Wrench([0, -1], 0.1), friction=0.5, tolerance=1e-6)
    assert chosen.gap <= 1e-6
    assert chosen.certificate.leaves < 200


UNIT_OF_FORCE = {"effort": 2, "friction_use": 0, "angle": 0, "answered": 0, "wrench": 0}
LARGE = ("angle", "force", "answered", "wrench", "wrench_ball")


@pytest.mark.parametrize(
    ("objective", "more"),
    [
        *((name, "") for name in (*OBJECTIVES, "friction_use", *LARGE)),
        *(("peak", name) for name in ("max_force", "min_normal", "keep", "removable")),
        *(
            ("sum_normal", name)
            for name in ("min_distance", "from_corners", "arcs", "tip_radius", "in_holes")
        ),
    ],
)
def test_units_turns_and_the_first_vertex_change_nothing(objective: str, more: str) -> None:
    """Lengths and forces a million times as large or small, a turn, and the vertices in another order."""
    vertices, constrained = star(6, 7).polygon(), more in ("max_force", "min_normal", "keep", "removable")
    loads = np.array([[0.3, -1, 0.1], [-0.2, -1, -0.1], [0, 0.5, 0.0]])[: 1 if constrained else 3]

    def chosen(scale: float, unit: float, turn: np.ndarray, order: np.ndarray) -> rg.ChosenGrasp:
        moved = (vertices @ turn.T * scale + [3 * scale, -scale])[order]
        hole = np.array([[0.1, 0.1], [0.4, 0.1], [0.2, 0.4]]) @ turn.T * scale + [3 * scale, -scale]
        outline = rg.Outline(moved, holes=[hole] if more == "in_holes" else [])
        held = np.column_stack([loads[:, :2] @ turn.T * unit, loads[:, 2] * unit * scale])
        first = float(outline.nearest(vertices[0] @ turn.T * scale + [3 * scale, -scale]))
        asked: dict[str, object] = {
            "max_force": {"max_force": 1.0 * unit},
            "min_normal": {"min_normal": 0.1 * unit},
            "keep": {"keep": lambda p, q, angle: np.hypot(*(p - q).T) < 1.8 * scale},
            "removable": {"removable": True},
            "min_distance": {"min_distance": 1.2 * scale},
            "from_corners": {"from_corners": 0.1 * scale},
            "arcs": {"arcs": [(first + 0.5 * scale, first + 4.5 * scale)]},
            "tip_radius": {"tip_radius": 0.2 * scale},
            "in_holes": {"in_holes": True},
        }.get(more, {})
        if constrained:
            asked["most_boxes"] = 64
        if objective in (*LARGE, "friction_use"):
            asked["max_force"] = 6.0 * unit
        load: rg.Wrench | rg.LoadSet = _hull(held)
        if objective in ("answered", "wrench"):
            load, asked["disturbance"] = rg.Wrench.from_vector(held[0]), _hull(0.2 * held)
        if objective == "wrench_ball":
            load, asked["length"] = rg.Wrench([0, 0]), 0.7 * scale
        asked["tolerance"] = 0.03 if objective == "wrench" else 1e-3
        return rg.choose_grasp(
            outline, 3 if more == "removable" else 2, load, friction=0.5, objective=objective, **asked
        )

    every = np.arange(len(vertices))
    base = chosen(1.0, 1.0, np.eye(2), every)
    sign = -1 if objective in LARGE else 1
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    moved = [(1e-6, 1e6, turn, np.roll(every[::-1], 3)), (1e6, 1e-6, np.eye(2), np.roll(every, 2))]
    for scale, unit, way, order in moved[: 1 if constrained or objective == "wrench" else 2]:
        given = chosen(scale, unit, way, order)
        per = unit ** UNIT_OF_FORCE.get(objective, 1)
        value, bound = given.value / per, given.bound / per
        assert value == pytest.approx(base.value, rel=0.03 if objective == "wrench" else 1e-3, abs=1e-6)
        assert sign * bound <= sign * base.value + 1e-9 * abs(base.value)
        assert sign * base.bound <= sign * value + 1e-9 * abs(value)


def _hull(vectors: np.ndarray) -> rg.LoadSet:
    return rg.LoadSet.hull(rg.Wrench.from_vector(v) for v in vectors)


@pytest.mark.parametrize(("objective", "largest"), [("friction_use", False), ("angle", True)])
@pytest.mark.parametrize(
    ("outline", "fingers", "count", "loads"), [(BRACKET, 2, 14, RING), (star(5, 8), 3, 7, TILTED)]
)
def test_no_sampled_placement_uses_less_friction(
    outline: rg.Outline, fingers: int, count: int, loads: rg.LoadSet, objective: str, largest: bool
) -> None:
    asked = {"friction": 0.5, "max_force": 3.0, "objective": objective}
    chosen = rg.choose_grasp(outline, fingers, loads, **asked)
    contacts = [outline.contact_at(s, friction=0.5) for s in outline.sample(count)]
    vertices = loads.vertices
    assert vertices is not None
    tried = 0
    for few in combinations(contacts, fingers):
        try:
            values = [
                rg.choose_state(rg.Grasp(few), rg.Wrench.from_vector(w), objective, max_force=3.0).value
                for w in vertices
            ]
        except rg.Infeasible:
            continue
        tried += 1
        assert min(values) <= chosen.bound if largest else max(values) >= chosen.bound
    assert tried > 0
    assert chosen.gap <= 5e-3
    assert (chosen.bound >= chosen.value) if largest else (chosen.bound <= chosen.value)
    assert rg.verify(chosen).ok


@pytest.mark.parametrize(("outline", "fingers", "count"), [(star(4, 9), 2, 14), (star(5, 8), 3, 7)])
def test_no_sampled_placement_answers_more(outline: rg.Outline, fingers: int, count: int) -> None:
    weight, limit = rg.Wrench([0, -1]), 3.0
    chosen = rg.choose_grasp(
        outline, fingers, weight, friction=0.5, objective="answered", disturbance=DEVIATIONS, max_force=limit
    )
    contacts = [outline.contact_at(s, friction=0.5) for s in outline.sample(count)]

    def answered(grasp: rg.Grasp) -> float:
        directions = map(rg.Wrench.from_vector, DEVIATIONS.vertices)  # type: ignore[arg-type]
        return min(rg.largest_load(grasp, d, base=weight, max_force=limit).factor for d in directions)

    best = 0.0
    for few in combinations(contacts, fingers):
        try:
            best = max(best, answered(rg.Grasp(few)))
        except rg.Infeasible:
            continue
    assert 0.1 < best <= chosen.bound
    assert answered(chosen.grasp) == pytest.approx(chosen.value, rel=1e-5)
    assert chosen.gap <= 5e-3
    assert rg.verify(chosen).ok


def test_an_edge_of_a_cone_is_reached_from_within() -> None:
    """The best are where a force is on an edge of its cone: beside it, towards more friction, none hold."""
    quadrilateral = rg.Outline([[0, 0], [4, 0], [3, 2], [0, 3]])
    chosen = rg.choose_grasp(quadrilateral, 2, rg.Wrench([0.2, -1], 0.1), friction=1.2, most_boxes=200)
    assert chosen.gap <= 1e-3
    assert chosen.value == pytest.approx(56 / 61, rel=1e-6)


def test_sides_that_meet_are_told_apart() -> None:
    """Loads that press on two sides beside a corner are near in place, and their forces are not."""
    shape = rg.Outline(
        [[-0.1, -0.1], [4.0, 0.2], [4.5, 3.1], [1.1, 3.6]], holes=[[[1.5, 1.1], [1.7, 1.0], [2.4, 1.0]]]
    )
    loads = rg.LoadSet.hull(
        [rg.Wrench([-0.3, -1.1], -0.2), rg.Wrench([-0.6, -1.0], 0.2), rg.Wrench([-0.1, -0.8], -0.1)]
    )
    chosen = rg.choose_grasp(
        shape, 3, loads, friction=0.5, objective="peak_normal", in_holes=True, most_boxes=1000
    )
    assert chosen.gap <= 1e-3
    assert chosen.value < 0.4615  # 0.852 while such a box was split everywhere else first
    nothing = replace(chosen, value=0.0)
    assert nothing.gap == np.inf
    assert replace(nothing, bound=0.0).gap == 0.0


def test_a_corner_that_all_loads_press_is_looked_at_before_the_others_are_halved_to_the_end() -> None:
    rng = np.random.default_rng(26)
    angle, radius = np.sort((np.arange(20) + 0.8 * rng.random(20)) / 20 * 2 * np.pi), 0.5 + rng.random(20)
    outline = rg.Outline(np.round(np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), 2))
    loads = rg.LoadSet.hull([
        rg.Wrench([x, y], torque)
        for x, y in ((1, 0), (-0.5, 0.9), (-0.5, -0.9)) for torque in (0.05, -0.05)
    ])  # fmt: skip
    chosen = rg.choose_grasp(
        outline, 3, loads, friction=0.4, objective="peak", from_corners=0.0, most_boxes=2000
    )
    assert chosen.gap <= 1e-3
    assert chosen.value < 0.89  # 1.67 where the other two were halved to the end


def test_placements_that_nearly_hold_slide_to_those_that_do() -> None:
    """All friction can be spared on an open set of placements, and none of 20,000 tried was in it."""
    corners = [[0.717, 0.899], [-0.229, 1.002], [-1.101, 0.53], [-1.119, -0.539], [-0.223, -0.978]]
    shape = rg.Outline.smooth([*corners, [0.691, -0.867], [1.193, 0.0]])
    two = rg.LoadSet.hull([rg.Wrench([0.07, -1.38], -0.06), rg.Wrench([-0.07, -0.87], -0.26)])
    chosen = rg.choose_grasp(shape, 3, two, friction=0.2, objective="angle", max_force=2.37, most_boxes=15000)
    assert chosen.gap <= 1e-3
    assert chosen.value == pytest.approx(np.arctan(0.2), rel=1e-3)


def test_fingers_slide_to_better_levels_not_to_lesser_forces() -> None:
    """On this shape forces are least beside places where cones end, and better than the last by one step."""
    vertices = [
        [0.91, 0.49], [0.52, 0.57], [0.08, 1.45], [-0.77, 0.5], [-0.73, 0.2], [-0.92, -0.53], [-0.62, -1.3],
        [0.63, -1.24], [0.93, -0.17],
    ]  # fmt: skip
    loads = [rg.Wrench([-0.16, -0.98], 0.23), rg.Wrench([-0.57, -1.1], 0.44), rg.Wrench([-0.22, -1.41], 0.08)]
    chosen = rg.choose_grasp(
        rg.Outline(vertices), 2, rg.LoadSet.hull(loads), friction=0.4, objective="friction_use",
        max_force=1.62, tolerance=1e-2, most_boxes=2000,
    )  # fmt: skip
    assert chosen.gap <= 1e-2
    assert chosen.value < 0.084  # 0.58 after ten times as many boxes


@pytest.mark.parametrize("max_force", [None, 5.0])
def test_four_fingers_without_friction_hold_every_orientation(max_force: float | None) -> None:
    # on each side in line with its opposite they need no more than the load itself
    shape = rg.Outline([[0, 0], [1, 0], [1, 3], [2.5, 3], [2.5, 4], [-1.5, 4], [-1.5, 3], [0, 3]])
    loads = rg.LoadSet.turned(rg.Wrench([0, -1]))
    found = rg.choose_grasp(shape, 4, loads, friction=0, objective="peak", max_force=max_force)
    assert found.bound <= 1 <= found.value <= 1 + 1e-3
    assert found.gap <= 1e-3
    assert rg.verify(found).ok


@pytest.mark.parametrize(
    ("load", "friction", "words"),
    [
        (rg.Wrench([0, -1]), 1e12, "friction must be at most 10000 here"),
        (rg.Wrench([0, -1e120]), 0.5, "loads must be from 1e-60 to 1e+60"),
        (rg.LoadSet.turned(rg.Wrench([0, -1e-70])), 0.5, "loads must be from 1e-60 to 1e+60"),
    ],
)
def test_numbers_that_leave_nothing_proven_are_refused(
    load: rg.Wrench | rg.LoadSet, friction: float, words: str
) -> None:
    with pytest.raises(rg.InvalidInput, match=words.replace("+", r"\+")):
        rg.choose_grasp(BRACKET, 2, load, friction=friction)


@pytest.mark.parametrize("size", [1e-60, 1e60])
@pytest.mark.parametrize("objective", OBJECTIVES)
def test_numbers_at_the_limits_are_proven(objective: str, size: float) -> None:
    for mu in 0.5, 1e4:
        found = rg.choose_grasp(BRACKET, 2, rg.Wrench([0, -size]), friction=mu, objective=objective)
        assert rg.verify(found).ok
        assert found.gap <= 1e-3
