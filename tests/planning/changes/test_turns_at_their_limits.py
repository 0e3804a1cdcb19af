"""Turns asked for at the edge of what is allowed, and what is handed out there."""

import warnings
from math import cos, inf, nextafter, pi

import numpy as np
import pytest

import regrasp as rg
from regrasp.mechanics.loads.rotated import turned_load

pytestmark = pytest.mark.contract

PAIR = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.8, name="A"), rg.Contact([1, 0], [-1, 0], 0.8, name="B")])
WEIGHT = rg.Wrench([0, -2])
SKEW = rg.Grasp([rg.Contact([-1, 0.1], [1, 0.3], 0.8), rg.Contact([1, 0.3], [-1, 0.1], 0.8)])
SHELF = rg.Grasp([rg.Contact([-1, -1], [0, 1], 0.9), rg.Contact([1, -1], [0, 1], 0.9)])


@pytest.mark.parametrize("given", [{}, {"angle": 0.3, "degrees": 20.0}])
def test_one_unit_is_asked_for(given) -> None:
    with pytest.raises(rg.InvalidInput, match=r"angle \[rad\] or as degrees=..., one of them"):
        rg.plan_rotation(PAIR, load=WEIGHT, **given)


@pytest.mark.parametrize("way", [1, -1])
def test_a_whole_turn_is_no_slip_and_more_is_asked_about_where_it_was_written(way) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        rg.plan_rotation(PAIR, way * 2 * pi, load=WEIGHT)
    with pytest.warns(UserWarning, match="whole turns") as told:
        rg.plan_rotation(PAIR, way * nextafter(2 * pi, inf), load=WEIGHT)
    assert told[0].filename == __file__


def test_an_end_that_is_no_state_is_refused() -> None:
    with pytest.raises(rg.InvalidInput, match="end must be a state"):
        rg.plan_rotation(PAIR, 0.3, load=WEIGHT, end="upright")


def test_each_chosen_end_and_each_least_push_is_recorded() -> None:
    plan = rg.plan_rotation(PAIR, 0.3, load=WEIGHT, min_normal=1.5)
    assert [choice.end for choice in plan.record.choices] == ["start", "end"]
    assert plan.record.least_normals == (1.5, 1.5)
    given = rg.plan_rotation(plan.start, 0.3, min_normal=1.5)
    assert [choice.end for choice in given.record.choices] == ["end"]


@pytest.mark.parametrize("way", [1, -1])
def test_room_for_what_grows_within_a_step_is_left_to_the_last_digits(way) -> None:
    """Under hardly any load forces stay, and grow by 1 / cos(step / 2) exactly."""
    plan = rg.plan_rotation(PAIR, way * pi / 3, load=rg.Wrench([0, -1e-6]), objective="force", max_force=9.0)
    assert plan.turn.angles.tolist() == [0.0, way * pi / 3]
    assert 9 - 2e-8 < plan.peak <= 9.0
    assert plan.start.magnitudes.max() == pytest.approx(9 * cos(pi / 6), rel=1e-8)


@pytest.mark.parametrize("way", [1, -1])
def test_what_cannot_be_held_on_the_way_is_refused_with_the_first_proof(way) -> None:
    """Both ends hold, and half a turn away nothing does: steps beyond it would be wider than pi."""
    with pytest.raises(rg.Infeasible, match=r"after a turn of -?1\.0472 rad") as refused:
        rg.plan_rotation(SHELF, way * 2 * pi, load=WEIGHT)
    assert refused.value.certificate.is_proof


def test_halving_ends_where_no_state_is_too_strong_but_all_between() -> None:
    """The crest misses a limit by a billionth, in 4e-5 rad, which no state on the way meets."""
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 2.0), rg.Contact([1, 0], [-1, 0], 2.0)])
    s, c = np.sin(np.linspace(1.1, 1.5, 100_001)), np.cos(np.linspace(1.1, 1.5, 100_001))
    needed = np.hypot(2 * s + c / 2, c).max()
    with pytest.raises(rg.Infeasible, match="above its limit"):
        rg.plan_rotation(pair, 2.0, load=WEIGHT, objective="effort", max_force=needed * (1 - 1e-9))


@pytest.mark.parametrize("torque", [0.0, 1e-16])
def test_a_turn_whose_forces_on_the_way_lose_its_load_is_refused(torque) -> None:
    """Both ends given, gentle; between them the widest margin under a limit of 1 N is chosen."""
    load = rg.Wrench([0, -1e-15], torque)
    start = rg.choose_state(SKEW, load, "effort")
    end = rg.choose_state(SKEW, turned_load(load, 2.0), "effort")
    assert max(start.magnitudes.max(), end.magnitudes.max()) < 1e-11
    with pytest.raises(rg.InvalidInput, match="times the load and round to"):
        rg.plan_rotation(start, 2.0, end=end, objective="force", max_force=1.0)


@pytest.mark.parametrize("torque", [0.0, 0.3])
def test_linear_limits_of_one_finger_alone_are_kept_on_the_way(torque) -> None:
    load = rg.Wrench([0, -2], torque)
    free = rg.plan_rotation(PAIR, 2.0, load=load, objective="effort")
    pushes = (free.forces(np.linspace(0, 1, 201)) @ PAIR.normals[0])[:, 0]
    limited = PAIR.replaced("A", PAIR["A"].changed(limits=([[1.0, 0.0]], [1.001 * pushes.max()])))
    plan = rg.plan_rotation(limited, 2.0, load=load, objective="effort")
    assert rg.verify(plan).ok


def test_what_is_lost_between_two_gentle_ends_is_refused() -> None:
    """Nothing but the state between them, chosen for a still torque, is strong."""
    load = rg.Wrench([0, -1e-15], 1e-16)
    ends = [rg.choose_state(SKEW, turned_load(load, turn), "effort") for turn in (0.0, 0.5)]
    with pytest.raises(rg.InvalidInput, match="times the load and round to"):
        rg.plan_rotation(ends[0], 0.5, end=ends[1], objective="force", max_force=1.0)
    plan = rg.plan_rotation(ends[0], 0.5, end=ends[1], objective="effort", max_force=1.0)
    assert rg.verify(plan).ok


@pytest.mark.parametrize("turn", [1e-12, -1e-12, 1e-300])
def test_the_smallest_turns_have_one_step(turn) -> None:
    plan = rg.plan_rotation(PAIR, turn, load=WEIGHT)
    assert plan.turn.angles.tolist() == [0.0, turn]
    assert rg.verify(plan).ok


def test_without_a_load_nothing_is_lost() -> None:
    plan = rg.plan_rotation(SKEW, 0.5, load=rg.Wrench([0, 0]), objective="force", max_force=1.0)
    assert plan.peak == pytest.approx(1.0, rel=1e-6)
    assert rg.verify(plan).ok


@pytest.mark.parametrize("way", [1, -1])
def test_steps_are_halved_either_way(way) -> None:
    pair = rg.Grasp([rg.Contact([-1, 0], [1, 0], 2.0), rg.Contact([1, 0], [-1, 0], 2.0)])
    s, c = np.sin(np.linspace(1.1, 1.5, 10_001)), np.cos(np.linspace(1.1, 1.5, 10_001))
    limit = np.hypot(2 * s + c / 2, c).max() * (1 + 1e-4)
    plan = rg.plan_rotation(pair, 2.0 * way, load=WEIGHT, objective="effort", max_force=limit)
    assert plan.turn.angles.size > 3
    assert rg.verify(plan).ok
