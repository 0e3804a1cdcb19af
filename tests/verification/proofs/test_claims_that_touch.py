"""Claims that touch their limit to the last bit hold; and what loads and places must be, by hand."""

from fractions import Fraction
from math import atan, hypot, inf, sin
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from proofs import planar
from regrasp.verification.placed import chosen_grasps as claims
from regrasp.verification.placed.claims import contacts, levels
from regrasp.verification.placed.whole_sets import makes_ball

pytestmark = pytest.mark.contract

ABOVE, BELOW, STEP = 1 + 1e-9, 1 - 1e-9, 2.0**-40
SQUARE = np.array([[-3.0, -4], [3, -4], [3, 4], [-3, 4]])
NODE = ([(0, 0, 0, 1)] * 2, (0, 0), 0, (0, 0, 1))
PAIR = rg.Grasp([rg.Contact([-3, 0], [1, 0], 0.5), rg.Contact([3, 0], [-1, 0], 0.5)])
MIXED = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.6)])


def chosen(objective, value=1.0, bound=1.0, **changes):
    given = {
        "objective": objective, "value": value, "bound": bound, "grasp": PAIR, "states": (), "others": (),
        "max_force": None, "min_normal": 0.0, "length": None, "deviations": None, "places": (25.0, 10.0),
        "certificate": SimpleNamespace(loads=np.zeros((1, 3))),
    }  # fmt: skip
    return SimpleNamespace(**given | changes)


def pressing(size, **margins):
    normals = np.array([[1.0, 0], [1, 0]])
    return SimpleNamespace(
        forces=size * normals, grasp=SimpleNamespace(normals=normals), margins=SimpleNamespace(**margins)
    )


def test_values_that_touch_their_limits() -> None:
    for objective, size, given in (
        ("peak", ABOVE, {"value": inf, "max_force": 1.0}),
        ("peak", BELOW, {"value": inf, "min_normal": 1.0}),
        ("peak_normal", ABOVE, {}),
    ):
        assert claims._check_value(chosen(objective, **given), pressing(size), 1) == []
    for objective, margins in (
        ("angle", {"least_angle": 1 - 1e-9}),
        ("force", {"least_force": BELOW}),
        ("friction_use", {"largest_friction_use": ABOVE}),
    ):
        assert claims._check_value(chosen(objective), pressing(1.0, **margins), 1) == []


def test_bounds_that_touch_their_limits() -> None:
    def told(proof, objective, value=1.0, bound=1.0, **given):
        proof = SimpleNamespace(**{"margin": 0.0, "bound": 3.0, "loads": np.zeros((1, 3))} | proof)
        return claims._check_bound(chosen(objective, value, bound, **{"max_force": 2.0} | given), proof)

    assert told({"bound": ABOVE}, "peak") == []
    assert told({"bound": 1.0}, "peak", 2.0, 1 + STEP) == []
    assert told({"friction": 0.5}, "friction_use", 2.0, 1 + STEP) == []
    assert told({"friction": 0.2}, "angle", 0.0, (atan(0.5) - atan(0.2)) * BELOW) == []
    sideways = {"loads": np.array([[0.0, 0, 0], [ABOVE, 0, 0]])}
    for grasp in PAIR, MIXED:  # no level of one coefficient
        given = {"deviations": np.array([[1.0, 0, 0]]), "grasp": grasp}
        assert told(sideways, "answered", **given) == []
    assert told({"loads": sideways["loads"][1:]}, "wrench_ball", 0.0, length=1.0) == []
    assert claims._check_others(chosen("peak", bound=0.0, others=(SimpleNamespace(value=0.0),))) == []


def test_bounds_without_proof_that_touch_their_limits() -> None:
    board = planar(SQUARE, [[0, 0, 0]], [NODE])
    ahead = {"deviations": np.array([[1.0, 0, 0]])}
    for objective, bound, given in (
        ("angle", atan(0.6), {"grasp": MIXED}),
        ("force", 3.0 * sin(atan(0.6)) * (1 - 1e-9), {"grasp": MIXED}),
        ("wrench_ball", 2 * 3.0 * hypot(1.0, 0.6), {"grasp": MIXED}),
        ("answered", 6.0, ahead),
    ):
        assert levels.check_trivial(chosen(objective, bound=bound, **given), board, 3.0) == []
        assert levels.check_trivial(chosen(objective, bound=bound * 0.999, **given), board, 3.0) != []


def test_loads_that_touch_their_limits() -> None:
    zero = SimpleNamespace(load=SimpleNamespace(vector=np.zeros(3)))
    none = chosen("answered", 0.0, deviations=np.zeros((1, 3)), states=(zero, zero))
    assert levels.check_answers(none) == []
    down = -np.ones(3)
    states = [SimpleNamespace(load=SimpleNamespace(vector=w)) for w in (down * (1 + 1e-10), 2 * down)]
    given = {"deviations": down[None], "certificate": SimpleNamespace(loads=down[None]), "states": states}
    assert levels.check_answers(chosen("answered", **given)) == []
    other = chosen("answered", deviations=np.eye(3)[:2])
    assert not levels._scaled_by_less(other, np.array([[0.0, 0, 0], [1, 0, 0], [0, 0, 0]]), 1.0)
    assert levels._scaled_by_less(other, np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]]), 1.0)
    assert not levels._scaled_by_less(chosen("answered", deviations=np.eye(3)), np.zeros((3, 3)), 1.0)


def test_places_that_touch_their_limits() -> None:
    nowhere = SimpleNamespace(grasp=SimpleNamespace(positions=np.zeros((2, 2))))
    assert contacts._off_their_places(nowhere, np.zeros((2, 2))) == []
    assert contacts._off_their_places(nowhere, np.zeros((1, 2))) == ["each contact needs a place"]
    near = np.array([[-2.0, -2], [-2, 2], [2, 2], [2, -2]])
    rings = {"vertices": np.concatenate([SQUARE, near]), "rings": np.array([0, 4])}
    shape = SimpleNamespace(cubics=lambda: None, polygon=lambda: SQUARE, hole_polygons=lambda: (near[::-1],))

    def told(shape=shape, **changes):
        proof = planar(**rings | {"loads": [[0, 0, 0]], "nodes": [NODE]} | changes)
        given = {"shape": shape, "places": (24.0, 10.0), "certificate": proof}
        return "; ".join(contacts.check_places(chosen("answered", **given), proof))

    assert told() == ""
    assert told(min_distance=6 + 5 * STEP) == ""
    assert "nearer" in told(min_distance=6 + 6 * STEP)
    assert told(rings=None) == "the proof is about another outline"
    for wrong in ([0, 5], [1, 4], [0], [0, 4, 8]):
        assert told(rings=np.array(wrong)) == "the proof is about another outline"
    turned = SimpleNamespace(**vars(shape) | {"hole_polygons": lambda: (near,)})
    assert told(turned) == "the proof is about another outline"
    assert told(SimpleNamespace(surface=lambda: ([], []))) == "the proof is about an outline"
    second = {"vertices": np.concatenate([rings["vertices"], near / 4]), "rings": np.array([0, 4, 8])}
    holes = SimpleNamespace(**vars(shape) | {"hole_polygons": lambda: (near[::-1], near[::-1] / 4)})
    assert told(holes, **second) == ""
    edges = np.stack([SQUARE, SQUARE / 2, np.roll(SQUARE, -1, 0) / 2, np.roll(SQUARE, -1, 0)], axis=1)
    for control, good in (edges, True), (np.nextafter(edges, 9), False):
        curved = SimpleNamespace(**vars(shape) | {"cubics": lambda control=control: control})
        words = told(curved, vertices=SQUARE, control=edges, rings=None)
        assert (words == "the proof is about another outline") != good
    floor = np.array([[0, 0, 1.0], [2, 2, 3.0]])
    assert "on none of the sides" in told(sides=floor)


def test_loads_between_those_of_states_are_shown() -> None:
    """Of two states, at the ends and between them, each by its own unit; and beyond them not."""

    def shown(load, *vectors):
        states = tuple(
            SimpleNamespace(load=SimpleNamespace(vector=np.array(v, dtype=float))) for v in vectors
        )
        return contacts._all_shown(SimpleNamespace(states=states), np.array([load], dtype=float))

    ends = [0, -1e3, 0], [0, -3e3, 4e-3]
    for part, good in (0, True), (0.25, True), (1, True), (1 + 1e-6, False), (-1e-6, False):
        load = np.array(ends[0]) + part * np.subtract(ends[1], ends[0])
        assert shown(load, *ends) == good, part
    assert not shown([0, -2e3, 2.1e-3], *ends)
    assert shown([0, 0, 0], [0, 0, 0])
    assert not shown([0, -1, 0])
    assert shown([0, -1e-6, 0], [0, -1e-6, 0])
    assert not shown([0, -1e-6, 0], [0, -2e-6, 0])
    assert shown([0, -1, 0], [5e-10, -1, 0])
    assert shown([0, -100, 0], [2e-8, -100, 0])
    assert not shown([0, -100, 0], [2e-7, -100, 0])
    assert not shown([0, 0, 0], [1e-300, 0, 0])
    assert not shown([0, 0, 1e9], [1e-3, 0, 1e9])  # a large torque loosens no force


def test_spots_that_touch_their_limits(monkeypatch) -> None:
    grasp = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], 0.5) for x in (-1, 1))
    monkeypatch.setattr(contacts, "touches", lambda *a: True)
    shape = SimpleNamespace(centre_of_mass=np.zeros(3))
    load = SimpleNamespace(load=SimpleNamespace(vector=np.zeros(6)))
    for share, apart, words in (
        (0.0, 2 + STEP, ""),
        (0.5, 2 + 2 * STEP, "two contacts are nearer than the least distance"),
        (-1.0, 0.0, "the proof is about another mesh"),
    ):
        given = {"fingers": 2, "friction": 0.5, "loads": np.zeros((1, 6))}
        proof = SimpleNamespace(**given, min_distance=apart)
        made = chosen("peak", grasp=grasp, shape=shape, states=(load,), places=grasp.positions)
        assert "; ".join(contacts.check_spots(made, proof, share)) == words


def test_what_is_said_of_springs() -> None:
    tied = planar(SQUARE, [[0, 0, 0]], [NODE], tied=np.zeros((0, 3)))
    assert claims._part(tied) == " of fingers that answer by equal stiffness"


def test_values_are_what_the_worst_of_the_states_shows() -> None:
    """A value is no worse than that, but for a billionth; the weaker of two states says what it is."""
    few = {"least_angle": 0.5, "least_force": 2.0, "largest_friction_use": 0.25}
    more = {"least_angle": 0.6, "least_force": 3.0, "largest_friction_use": 0.125}
    states = pressing(2.0, **few), pressing(1.0, **more)
    for objective, shown, way in (
        ("sum_normal", 4.0, 1), ("peak_normal", 2.0, 1), ("peak", 2.0, 1), ("effort", 8.0, 1),
        ("friction_use", 0.25, 4), ("angle", 0.5, -2), ("force", 2.0, -1),
    ):  # fmt: skip
        for part, good in (0.0, True), (0.9e-9, True), (1.1e-9, False), (1.0, False), (1e300, False):
            value = shown * (1 + way * part)
            for order in states, states[::-1]:
                found = claims._check_shown(chosen(objective, value, states=order))
                words = f"value {value:.12g} is worse than what the states show, {shown:.12g}"
                assert found == ([] if good else [words]), (objective, part)
    idle = pressing(0.0, largest_friction_use=np.nan)  # no force uses friction
    for order in (idle, *states), (*states, idle):
        for value, good in (0.25, True), (0.3, False):
            assert (claims._check_shown(chosen("friction_use", value, states=order)) == []) == good
    for value, good in (0.0, True), (0.9e-9, True), (1.1e-9, False):
        assert (claims._check_shown(chosen("friction_use", value, states=(idle,))) == []) == good
    slips = pressing(1.0, least_force=-2.0)
    for value, good in (-2.0, True), (-2.0 - 1.9e-9, True), (-2.0 - 2.1e-9, False):
        assert (claims._check_shown(chosen("force", value, states=(slips,))) == []) == good


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
def test_a_ball_is_no_smaller_than_the_fingers_make(scale) -> None:
    """Three fingers around a disc, and what rounding of the largest wrench leaves of the radius."""
    turns = 2 * np.pi * np.arange(3) / 3
    out = np.stack([np.cos(turns), np.sin(turns)], axis=1)
    grasp = rg.Grasp([rg.Contact(scale * p, -p, 0.5) for p in out])
    low, high = 0.0, 3.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        held = makes_ball(grasp, 2.0, scale, Fraction(middle))
        low, high = (middle, high) if held else (low, middle)
    assert low > 0.1
    slack = 1e-9 * (low + 6 * np.hypot(1, 0.5))  # three forces of at most 2 along n and half of it across
    for off, good in (0.0, True), (0.99 * slack, True), (1.01 * slack, False), (low, False):
        found = claims._check_shown(
            chosen(
                "wrench_ball", low - off, grasp=grasp, length=scale, max_force=2.0, states=(pressing(1.0),)
            )
        )
        words = f"value {low - off:.12g} is worse than the ball of wrenches that the fingers make"
        assert found == ([] if good else [words]), off
