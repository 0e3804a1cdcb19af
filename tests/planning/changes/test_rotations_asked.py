"""Which turns are asked for."""

from math import cos, pi

import pytest

import regrasp as rg
from paper import STATE
from regrasp.mechanics.loads.rotated import turned_load

pytestmark = pytest.mark.contract


@pytest.mark.parametrize("degrees", [6e4, -6e4, 1e30, 1e308])
def test_turns_that_would_never_end_are_refused(degrees: float) -> None:
    with pytest.raises(rg.InvalidInput, match="at most 1000 rad"):
        rg.plan_rotation(STATE, degrees=degrees)


SQUEEZE = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.8), rg.Contact([1, 0.1], [-1, 0], 0.8)])


@pytest.mark.parametrize("size", [1e-3, 1e3])
@pytest.mark.parametrize("turn", [0.5, -0.5])
@pytest.mark.parametrize("force", [[0.0, -2.0], [-1.5, -2.0]])
def test_the_load_of_an_end_is_that_of_the_turn_to_a_billionth(size: float, turn: float, force: list) -> None:
    start = rg.choose_state(SQUEEZE, size * rg.Wrench(force), "effort")
    seen = turned_load(start.load, turn)
    best = rg.choose_state(SQUEEZE, seen, "effort")
    for off, good in ((0.9e-9, True), (1.1e-9, False), (-0.9e-9, True), (-1.1e-9, False)):
        load = rg.Wrench(seen.force, off * abs(seen.vector).max())
        end = rg.GraspState(SQUEEZE, load, best.forces)
        if good:
            assert rg.plan_rotation(start, turn, end=end).end.load == seen
        else:
            with pytest.raises(rg.InvalidInput, match="end must be a state of the same contacts under the"):
                rg.plan_rotation(start, turn, end=end)


@pytest.mark.parametrize("turn", [pi / 3, -pi / 3])
def test_room_is_left_for_forces_that_grow_within_a_step(turn: float) -> None:
    """Ends at the limit times cos(turn / 2) need no state between them."""
    plan = rg.plan_rotation(SQUEEZE, turn, load=rg.Wrench([0, -0.1]), objective="force", max_force=9.0)
    assert plan.turn.angles.tolist() == [0.0, turn]
    assert plan.peak <= 9.0
    assert plan.start.magnitudes.max() == pytest.approx(9 * cos(turn / 2), rel=1e-3)


@pytest.mark.parametrize("which", ["start", "end"])
def test_given_ends_that_press_too_little_are_refused(which: str) -> None:
    start = rg.choose_state(SQUEEZE, rg.Wrench([0, -1]), "effort")
    end = rg.choose_state(SQUEEZE, turned_load(start.load, 0.4), "effort")
    normals = [min((s.forces * SQUEEZE.normals).sum(axis=1)) for s in (start, end)]
    least = normals[which == "end"]
    strong = rg.choose_state(
        SQUEEZE, (end if which == "start" else start).load, "effort", min_normal=2 * least
    )
    ends = (start, strong) if which == "start" else (strong, end)
    assert rg.plan_rotation(ends[0], 0.4, end=ends[1], min_normal=least * (1 - 1e-6))
    with pytest.raises(rg.RegraspError):
        rg.plan_rotation(ends[0], 0.4, end=ends[1], min_normal=least * (1 + 1e-6))
