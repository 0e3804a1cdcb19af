"""Chosen grasps against all pairs and triples of sampled points, and against other coordinates."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest
from scipy.optimize import linprog

import regrasp as rg
from refusals import refusal

pytestmark = pytest.mark.oracle

BRACKET = rg.Outline([[0, 0], [4, 0], [4, 1], [1, 1], [1, 3], [0, 3]])
TILTED = rg.LoadSet.hull(
    [rg.Wrench([0, -1], 0.2), rg.Wrench([0, -1], -0.2), rg.Wrench([0.3, -1]), rg.Wrench([-0.3, -1])]
)
RING = rg.LoadSet.hull(rg.Wrench([np.cos(t), np.sin(t)]) for t in np.arange(6) * np.pi / 3)
OBJECTIVES = ("sum_normal", "peak_normal", "peak", "effort")


def star(seed: int, count: int) -> rg.Outline:
    rng = np.random.default_rng(seed)
    angles = (np.arange(count) + rng.uniform(0.1, 0.9, count)) * 2 * np.pi / count
    radii = rng.uniform(0.7, 1.3, count)
    return rg.Outline(np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1))


def least_normals(grasp: rg.Grasp, load: rg.Wrench, largest: bool) -> float:
    """Least sum, or largest, of normal forces, written once more for a solver of linear programs."""
    columns = []
    for contact in grasp:
        x, y = contact.position
        nx, ny = contact.normal
        for side in (-contact.friction, contact.friction):
            fx, fy = nx - side * ny, ny + side * nx
            columns.append([fx, fy, x * fy - y * fx])
    G, n = np.array(columns).T, len(columns)
    if not largest:
        found = linprog(np.ones(n), A_eq=G, b_eq=-load.vector, method="highs")
    else:
        rows = np.kron(np.eye(n // 2), [1.0, 1.0])
        found = linprog(
            np.append(np.zeros(n), 1.0),
            A_ub=np.column_stack([rows, -np.ones(n // 2)]),
            b_ub=np.zeros(n // 2),
            A_eq=np.column_stack([G, np.zeros(3)]),
            b_eq=-load.vector,
            method="highs",
        )
    return float(found.fun) if found.status == 0 else np.inf


def value_of(grasp: rg.Grasp, loads: np.ndarray, objective: str) -> float:
    worst = 0.0
    for vector in loads:
        load = rg.Wrench.from_vector(vector)
        if objective in ("sum_normal", "peak_normal"):
            worst = max(worst, least_normals(grasp, load, objective == "peak_normal"))
        else:
            try:
                worst = max(worst, rg.choose_state(grasp, load, objective).value)
            except rg.Infeasible:
                return np.inf
    return worst


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


@pytest.mark.parametrize("objective", OBJECTIVES)
def test_units_turns_and_the_first_vertex_change_nothing(objective: str) -> None:
    vertices = star(6, 7).polygon()
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    loads = np.array([[0.3, -1, 0.1], [-0.2, -1, -0.1], [0, 0.5, 0.0]])
    base = rg.choose_grasp(rg.Outline(vertices), 2, _hull(loads), friction=0.5, objective=objective)
    turned = np.column_stack([loads[:, :2] @ turn.T, loads[:, 2]])
    power = 2 if objective == "effort" else 1
    for scale, unit in ((1.0, 1.0), (1e-4, 1e3), (1e5, 1e-5)):
        moved = np.roll(vertices[::-1], 3, axis=0) @ turn.T * scale + [3 * scale, -scale]
        given = rg.choose_grasp(
            rg.Outline(moved),
            2,
            _hull(turned * [unit, unit, unit * scale]),
            friction=0.5,
            objective=objective,
        )
        assert given.value / unit**power == pytest.approx(base.value, rel=1e-3)
        assert given.bound / unit**power <= base.value * (1 + 1e-9)
        assert base.bound <= given.value / unit**power * (1 + 1e-9)


def _hull(vectors: np.ndarray) -> rg.LoadSet:
    return rg.LoadSet.hull(rg.Wrench.from_vector(v) for v in vectors)


def test_every_orientation_is_held_by_what_is_chosen() -> None:
    load = rg.LoadSet.turned(rg.Wrench([0, -2]))
    chosen = rg.choose_grasp(BRACKET, 3, load, friction=0.5)
    angles = np.linspace(0, 2 * np.pi, 50)
    loads = np.stack([2 * np.cos(angles), 2 * np.sin(angles), 0 * angles], axis=1)
    worst = value_of(chosen.grasp, loads, "sum_normal")
    assert chosen.value * (1 - 2e-3) <= worst <= chosen.value
    assert chosen.bound <= worst * 1.001  # the worst orientation is between two of these
    assert len(chosen.states) >= 8
    assert rg.verify(chosen).ok
    assert any("has no state" in v for v in rg.verify(replace(chosen, states=chosen.states[1:])).violations)


def test_the_states_hold_the_loads_of_a_hull_and_no_force_holds_no_load() -> None:
    chosen = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4)
    assert sorted(tuple(s.load.vector) for s in chosen.states) == sorted(map(tuple, TILTED.vertices))
    sums = [(s.forces * s.grasp.normals).sum() for s in chosen.states]
    assert max(sums) == pytest.approx(chosen.value, rel=1e-12)
    idle = rg.choose_grasp(BRACKET, 2, rg.Wrench([0, 0]), friction=0.4)
    assert (idle.value, idle.bound, idle.gap) == (0.0, 0.0, 0.0)


def test_where_nothing_holds_it_says_so_with_a_proof() -> None:
    """Two frictionless fingers make a pure torque only with opposite normals, which a triangle has not."""
    triangle = rg.Outline([[0, 0], [4, 0], [1, 3]])
    with pytest.raises(rg.Infeasible, match="no 2 fingers anywhere") as caught:
        rg.choose_grasp(triangle, 2, rg.Wrench([0, 0], 1.0), friction=0.0)
    proof = caught.value.certificate
    assert rg.verify(proof).ok


def test_fingers_keep_apart_and_away_from_corners() -> None:
    chosen = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, objective="peak", min_distance=3.0)
    a, b = chosen.grasp.positions
    assert np.hypot(*(a - b)) >= 3.0 * (1 - 1e-9)
    free = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, objective="peak")
    assert free.bound <= chosen.value
    away = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, from_corners=0.3)
    corners = BRACKET.boundary.corners
    assert np.abs(away.places[:, None] - corners).min() >= 0.3 - 1e-9
    with pytest.raises(rg.InvalidInput, match="from_corners"):
        rg.choose_grasp(BRACKET, 2, TILTED, friction=0.4, from_corners=3.0)


def test_a_search_cut_short_keeps_an_honest_gap() -> None:
    chosen = rg.choose_grasp(
        star(5, 8), 3, TILTED, friction=0.4, objective="effort", tolerance=1e-9, most_boxes=64
    )
    assert 1e-9 < chosen.gap < 1
    assert rg.verify(chosen).ok
    better = rg.choose_grasp(star(5, 8), 3, TILTED, friction=0.4, objective="effort")
    assert chosen.bound <= better.value


def test_on_a_knifes_edge_the_gap_says_so() -> None:
    """Loads through the centre of mass may all be held only where a cone's edge passes through it, too."""
    chosen = rg.choose_grasp(
        star(4, 9), 2, TILTED, friction=0.5, objective="friction_use", max_force=3.0, most_boxes=2000
    )
    assert chosen.gap > 1e-3
    assert rg.verify(chosen).ok
    # where loads may be a little beside their lines, no such placement is left
    robust = rg.choose_grasp(star(4, 9), 2, TILTED, friction=0.4, load_offset=0.01)
    knife = rg.choose_grasp(star(4, 9), 2, TILTED, friction=0.4)
    assert knife.bound <= robust.value
    assert robust.gap <= 1e-3
    assert len(robust.certificate.loads) == 8
    for load in robust.certificate.loads:
        assert value_of(robust.grasp, load[None], "sum_normal") <= robust.value * (1 + 1e-6)


def test_progress_sees_both_bounds_close_in() -> None:
    seen: list[tuple[float, float]] = []
    rg.choose_grasp(star(8, 12), 3, TILTED, friction=0.3, progress=lambda low, high: seen.append((low, high)))
    lows, highs = np.array(seen).T
    assert (np.diff(lows) >= -1e-9 * abs(lows[1:])).all()
    assert (np.diff(highs) <= 0).all()


def test_what_cannot_be_answered_is_refused() -> None:
    for given, words in (
        ({"objective": "force"}, "objective must be one of sum_normal"),
        ({"shape": [[0, 0], [1, 0], [0, 1]]}, "shape must be an Outline"),
        ({"load": rg.Wrench([0, 0, 1])}, "planar load"),
        ({"tolerance": 2.0}, "tolerance"),
        ({"fingers": 5}, "fingers"),
    ):
        asked = {"shape": BRACKET, "fingers": 2, "load": TILTED, "friction": 0.4} | given
        assert words in str(refusal(lambda asked=asked: rg.choose_grasp(**asked)))


DEVIATIONS = rg.LoadSet.hull(
    [rg.Wrench([0, 0], 0.2), rg.Wrench([0, 0], -0.2), rg.Wrench([0.3, 0]), rg.Wrench([-0.3, 0])]
)


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


def test_a_level_that_no_placement_reaches_is_refused_with_a_proof() -> None:
    with pytest.raises(rg.Infeasible, match=r"forces of at most 0\.2 N") as caught:
        rg.choose_grasp(BRACKET, 3, TILTED, friction=0.5, objective="friction_use", max_force=0.2)
    assert rg.verify(caught.value.certificate).ok


def test_limits_and_disturbances_go_with_their_objectives() -> None:
    for more, words in (
        ({"objective": "angle"}, "max_force"),
        ({"objective": "angle", "max_force": 3.0, "min_normal": 0.1}, "min_normal"),
        ({"removable": True}, "three fingers"),
        ({"keep": lambda p, q: True}, "keep"),
        ({"keep": lambda p, q, angle: [True, True]}, "keep must return"),
        ({"objective": "answered", "max_force": 3.0}, "disturbance"),
        ({"objective": "peak", "disturbance": DEVIATIONS}, "disturbance"),
        ({"objective": "answered", "max_force": 3.0, "disturbance": DEVIATIONS}, "one load"),
        ({"objective": "friction_use", "max_force": 3.0, "friction": 0.0}, "friction"),
        ({"objective": "angle", "max_force": 3.0, "load": rg.Wrench([0, 0])}, "other than zero"),
    ):
        asked = {"shape": BRACKET, "fingers": 2, "load": TILTED, "friction": 0.4} | more
        assert words in str(refusal(lambda asked=asked: rg.choose_grasp(**asked)))


def test_fingers_stay_within_arcs() -> None:
    arcs = [(13.5, 2.0), (6.0, 7.0)]  # the first runs past the first vertex
    chosen = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.6, arcs=arcs, load_offset=1e-3)
    for s in chosen.places:
        assert 0 <= s <= 2.0 or 6.0 <= s <= 7.0 or s >= 13.5
    free = rg.choose_grasp(BRACKET, 2, TILTED, friction=0.6, load_offset=1e-3)
    assert free.bound <= chosen.value
    assert rg.verify(chosen).ok
    assert float((chosen.certificate.sides[:, 2] - chosen.certificate.sides[:, 1]).max()) <= 1.0
    whole = rg.choose_grasp(
        BRACKET, 2, TILTED, friction=0.6, arcs=[(1.0, 1.0 + BRACKET.length)], load_offset=1e-3
    )
    assert whole.value == pytest.approx(free.value, rel=1e-3)
    for none in ([], [(0, 2.01 * BRACKET.length)], [(-1.01 * BRACKET.length, 0)]):
        assert "arcs" in str(
            refusal(lambda none=none: rg.choose_grasp(BRACKET, 2, TILTED, friction=0.6, arcs=none))
        )


@pytest.mark.parametrize("radius", [0.1, 0.3, 0.45, 0.6])
def test_round_tips_touch_nothing_else(radius: float) -> None:
    """Against the distance of the tip's centre to the outline, by sampling; a slot one wide takes no 0.6."""
    from regrasp.planning.placement.reachable import sides_of

    slotted = rg.Outline([[0, 0], [5, 0], [5, 3], [3, 3], [3, 1], [2, 1], [2, 3], [0, 3]])
    sides = sides_of(slotted, 0.0, None, radius)
    ring = slotted.points(np.linspace(0, slotted.length, 4001))
    for s in np.linspace(0.01, slotted.length - 0.01, 331):
        point, normal = slotted.points(s), slotted.normals(s)
        reach = np.hypot(*(ring - (point - radius * normal)).T).min()
        edge = int(np.searchsorted(sides.starts, s, side="right")) - 1
        u = edge + (s - sides.starts[edge]) / sides.lengths[edge]
        allowed = bool(((sides.ends[:, 0] <= u) & (u <= sides.ends[:, 1])).any())
        if abs(reach - radius) > 0.01:
            assert not allowed
        elif allowed:
            assert reach >= radius - 1e-3
    inside = (sides.edges == 4).any()
    assert inside == (radius < 0.5)


DEGENERATE = {
    "needle": rg.Outline([[0, 0], [10, 0], [10, 1e-3], [0, 1e-3]]),
    "collinear points and tiny edges": rg.Outline(
        [[0, 0], [1, 0], [2, 0], [2 + 1e-6, 0], [4, 0], [4, 3], [2, 3 + 1e-7], [0, 3]]
    ),
    "pocket and hole": rg.Outline(
        [[0, 0], [5, 0], [5, 3], [3, 3], [3, 1], [2, 1], [2, 3], [0, 3]],
        holes=[[[0.4, 0.4], [0.4, 0.8], [0.8, 0.4]]],
    ),
    "chords of an ellipse": rg.Outline(rg.Outline.ellipse(2, 1).polygon(0.01)),
}


@pytest.mark.parametrize("name", DEGENERATE)
@pytest.mark.parametrize("friction", [0.0, 1e-12, 0.3])
def test_a_degenerate_outline_has_an_answer_or_a_refusal_with_a_proof(name: str, friction: float) -> None:
    outline = DEGENERATE[name]
    load = rg.LoadSet.hull([rg.Wrench([0.3, -1], 0.1), rg.Wrench([0, 0]), rg.Wrench([-0.2, -0.5])])
    for objective in ("sum_normal", "peak"):
        try:
            chosen = rg.choose_grasp(
                outline, 3, load, friction=friction, objective=objective, from_corners=0.0, most_boxes=1000
            )
        except rg.Infeasible as refused:
            proven = refused.certificate
        else:
            proven = chosen
            assert chosen.bound <= chosen.value
        assert rg.verify(proven).ok


def test_fingers_that_do_nothing_in_the_worst_load_are_on_the_outline_too() -> None:
    """Four fingers on chords: each stands on a side that the proof is about, whatever loads it answers."""
    chords = DEGENERATE["chords of an ellipse"]
    rng = np.random.default_rng(0)
    for _ in range(12):
        loads = rg.LoadSet.hull(rg.Wrench(rng.normal(size=2), float(rng.normal())) for _ in range(2))
        chosen = rg.choose_grasp(chords, 4, loads, friction=0.4, most_boxes=1000)
        assert rg.verify(chosen).ok


def test_fingers_further_apart_than_the_outline_is_wide_are_refused_at_once() -> None:
    square = rg.Outline([[0, 0], [3, 0], [3, 4], [0, 4]])
    with pytest.raises(rg.InvalidInput, match=r"no two points of the shape are further apart than 5$"):
        rg.choose_grasp(square, 2, rg.Wrench([0, -1]), friction=0.5, objective="peak", min_distance=5.001)
