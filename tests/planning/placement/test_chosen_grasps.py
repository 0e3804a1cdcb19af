"""What a chosen grasp says of itself: states, bounds and gaps, proofs of refusals, progress."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import regrasp as rg
from placements import BRACKET, TILTED, star, value_of
from regrasp.planning.placement.loads import inner_and_outer
from regrasp.planning.placement.symmetries import images
from values import placed

pytestmark = pytest.mark.oracle


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


@pytest.mark.parametrize("tolerance", [0.3, 0.02])
def test_loads_around_a_round_set_are_near_it_and_cost_no_more_than_the_tolerance(tolerance: float) -> None:
    """Every orientation is a set about the origin, however its first load points."""
    load = rg.LoadSet.turned(rg.Wrench([0, -1]))
    inner, outer = (np.hypot(*loads[:, :2].T) for loads in inner_and_outer(load, tolerance))
    assert np.ptp(inner) < 1e-12
    assert np.ptp(outer) < 1e-12
    assert 1 + tolerance / 4 < outer[0] < 1 + tolerance or len(outer) == 8
    for objective in ("peak", "effort"):
        chosen = rg.choose_grasp(
            rg.Outline.ellipse(2, 1), 2, load, friction=0.8, objective=objective, tolerance=tolerance
        )
        assert chosen.gap <= tolerance


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
    assert chosen.gap > 1e-4
    assert rg.verify(chosen).ok
    # where loads may be a little beside their lines, no such placement is left
    robust = rg.choose_grasp(star(4, 9), 2, TILTED, friction=0.4, load_offset=0.01)
    knife = rg.choose_grasp(star(4, 9), 2, TILTED, friction=0.4)
    assert knife.bound <= robust.value
    assert robust.gap <= 1e-3
    assert len(robust.certificate.loads) == 8
    for load in robust.certificate.loads:
        assert value_of(robust.grasp, load[None], "sum_normal") <= robust.value * (1 + 1e-6)


def test_round_loads_beside_their_lines_are_held_by_mixtures_of_states() -> None:
    """Those of the bound are within the outer ones, between no two of them."""
    loads = rg.LoadSet.turned(rg.Wrench([0, -1]))
    chosen = rg.choose_grasp(BRACKET, 3, loads, friction=0.5, load_offset=0.1, tolerance=0.1, most_boxes=200)
    assert rg.verify(chosen).ok
    for states in chosen.states[1:], chosen.states[:-1], ():
        said = rg.verify(replace(chosen, states=states)).violations
        assert "a load of the proof has no state" in said


@pytest.mark.parametrize("fingers", [2, 3])
def test_at_critical_friction_what_rounding_decides_hides_no_placement_that_holds(fingers: int) -> None:
    """Two loads at the friction angle of the lowest side: fingers on it hold by exact arithmetic alone."""
    loads = rg.LoadSet.hull(
        [
            rg.Wrench([0.3, -1], 0.13),
            rg.Wrench([-0.3, -1], 0.13),
            rg.Wrench([0, -1], -0.27),
            rg.Wrench([0.1, -1], 0.27),
        ]
    )
    asked = {"objective": "peak", "from_corners": 0.0, "most_boxes": 5000}
    chosen = rg.choose_grasp(BRACKET, fingers, loads, friction=0.3, **asked)
    less = rg.choose_grasp(BRACKET, fingers, loads, friction=0.3 * (1 - 1e-5), **asked)
    more = rg.choose_grasp(BRACKET, fingers, loads, friction=0.3 * (1 + 1e-5), **asked)
    assert chosen.value <= less.value * (1 + 1e-3)
    assert chosen.bound <= more.value  # what holds by exact arithmetic counts for the bound
    assert more.value < 0.7 * less.value
    assert rg.verify(chosen).ok


def test_progress_sees_both_bounds_close_in() -> None:
    seen: list[tuple[float, float]] = []
    chosen = rg.choose_grasp(star(8, 12), 3, TILTED, friction=0.3, progress=lambda *known: seen.append(known))
    lows, highs = np.array(seen).T
    assert seen[-1] == (chosen.bound, chosen.value)
    assert (np.diff(lows) >= -1e-9 * abs(lows[1:])).all()
    assert (np.diff(highs) <= 0).all()


def test_progress_of_a_level_ends_at_value_and_bound() -> None:
    seen: list[tuple[float, float]] = []
    asked = {"friction": 0.5, "max_force": 3.0, "objective": "friction_use"}
    chosen = rg.choose_grasp(BRACKET, 2, TILTED, progress=lambda *known: seen.append(known), **asked)
    bounds, values = np.array(seen).T
    assert (bounds <= chosen.value).all()
    assert np.nanmin(values) == values[-1] == chosen.value
    assert bounds[-1] == chosen.bound


def test_a_level_that_no_placement_reaches_is_refused_with_a_proof() -> None:
    with pytest.raises(rg.Infeasible, match=r"forces of at most 0\.2 N") as caught:
        rg.choose_grasp(BRACKET, 3, TILTED, friction=0.5, objective="friction_use", max_force=0.2)
    assert rg.verify(caught.value.certificate).ok


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


def test_a_load_that_is_held_is_no_refusal_where_no_deviation_is_answered() -> None:
    """Two fingers without friction, side by side below: they hold the load, and nothing across it."""
    across = rg.LoadSet.hull([rg.Wrench([0.3, 0]), rg.Wrench([-0.3, 0])])
    chosen = rg.choose_grasp(
        DEGENERATE["needle"], 2, rg.Wrench([0, -1]), friction=0.0, objective="answered", max_force=3.0,
        disturbance=across, from_corners=0.0,
    )  # fmt: skip
    assert 0 <= chosen.value <= chosen.bound < 1e-5
    assert rg.verify(chosen).ok


def test_fingers_that_do_nothing_in_the_worst_load_are_on_the_outline_too() -> None:
    """Four fingers on chords: each stands on a side that the proof is about, whatever loads it answers."""
    chords = DEGENERATE["chords of an ellipse"]
    rng = np.random.default_rng(0)
    for _ in range(12):
        loads = rg.LoadSet.hull(rg.Wrench(rng.normal(size=2), float(rng.normal())) for _ in range(2))
        chosen = rg.choose_grasp(chords, 4, loads, friction=0.4, most_boxes=1000)
        assert rg.verify(chosen).ok


def test_what_was_passed_over_is_worth_what_it_says() -> None:
    """Two of these were judged by one load of four, which they hold better than the others."""
    crooked = [[1.19, 0.57], [0.7, 1.12], [0.17, 0.55], [-0.49, 1.38], [-0.75, 0.38], [-0.61, -0.29]]
    crooked += [[-0.46, -0.91], [-0.05, -1.12], [0.34, -0.39], [0.58, -0.29]]
    loads = np.array([[-0.9, -0.73, -0.06], [0.27, -0.48, -0.33], [-0.13, -0.64, 0.28], [0.15, -1.3, -0.16]])
    held = rg.LoadSet.hull(map(rg.Wrench.from_vector, loads))
    chosen = rg.choose_grasp(rg.Outline(crooked), 2, held, friction=1.0)
    values = [other.value for other in chosen.others]
    assert len(values) >= 3
    assert [chosen.value, *values] == sorted([chosen.value, *values])
    for other in chosen.others:
        assert value_of(other.grasp, loads, "sum_normal") == pytest.approx(other.value, rel=1e-6)


def test_images_by_symmetry_are_no_other_grasps() -> None:
    box = rg.Outline([[0, 0], [4, 0], [4, 2], [0, 2]])
    angles = np.arange(6) * np.pi / 3
    loads = rg.LoadSet.hull(rg.Wrench([np.cos(t), np.sin(t)], m) for t in angles for m in (0.1, -0.1))
    chosen = rg.choose_grasp(box, 2, loads, friction=0.6)
    shown = [chosen.places, *(other.places for other in chosen.others)]
    assert len(shown) >= 4
    for turned in (lambda s: s + 6, lambda s: 4 - s, lambda s: 10 - s):
        for a, b in combinations(shown, 2):
            away = np.abs(np.sort(turned(a) % 12) - np.sort(b))
            assert np.minimum(away, 12 - away).max() > 0.1 or np.abs(np.sort(a) - np.sort(b)).max() < 0.1


@pytest.mark.parametrize(
    ("loads", "count"),
    [
        ([[0, -1, 0.0]], 2),
        ([[0, -1, 0.1]], 1),
        ([[0, 0, 1.0]], 4),
        ([[1, 0, 0], [0, 1, 0], [-1, 0, 0.0], [0, -1, 0]], 8),
    ],
    ids=["down", "down beside", "a torque", "four ways"],
)
def test_symmetries_of_a_square_are_those_of_its_loads(loads: list[list[float]], count: int) -> None:
    square = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1.0]])
    found = images(square, np.array(loads), np.array([0.2]))
    edge = found[:, 0].astype(int)
    along = found - edge[:, None]
    points = (1 - along) * square[edge] + along * square[(edge + 1) % 4]
    assert len(found) == count == len(np.unique(np.round(points, 9), axis=0))
    assert np.abs(points).max(axis=1) == pytest.approx(np.ones(count))
    halves = np.insert(square, [1, 2, 3, 4], [[0, -1], [1, 0], [0, 1], [-1, 0.0]], axis=0)
    assert len(images(halves, np.array(loads), np.array([0.2]))) == count  # vertices within sides


@pytest.mark.parametrize(
    ("objective", "word"),
    [("peak", "below"), ("friction_use", "below"), ("angle", "above"), ("wrench_ball", "above")],
)
def test_no_placement_is_on_the_better_side_of_the_bound_though_the_gap_is_closed(
    objective: str, word: str
) -> None:
    closed = replace(placed(), objective=objective, bound=placed().value)
    assert f"; no placement is {word} {closed.bound:.6g}, a gap of 0" in str(closed)


def test_columns_stay_apart_and_rounding_is_no_number() -> None:
    first, second = placed().grasp
    moved = rg.Contact([-0.00956194321, -0.00313698765], normal=first.normal, friction=0.5, name="F1")
    flat = rg.Contact([0.024, 1.7e-18], normal=second.normal, friction=0.5, name="F2")
    lines = str(replace(placed(), grasp=rg.Grasp([moved, flat]), places=np.array([0.123456789, 2.0])))
    assert "  0.123457  (-0.00956194, -0.00313699)  " in lines
    assert "(0.024, 0)" in lines


@pytest.mark.parametrize("objective", ["friction_use", "angle"])
def test_what_verify_lets_a_value_be_off_is_printed_as_nothing(objective: str) -> None:
    little = replace(placed(), objective=objective, value=1.4e-18, bound=-0.0)
    first, last = str(little).splitlines()[-1].split("; ")
    assert first.removesuffix(" rad") == f"{objective} 0"
    assert last.endswith(" 0, a gap of 0")
    assert f"({objective} 0, bound 0, gap 0, " in repr(little)
    assert f"{objective} 2e-09" in str(replace(little, value=2e-9))
    assert "peak 1.4e-18 N" in str(replace(little, objective="peak"))
