"""Each end of a plan keeps the limits of its own criteria, and the path between the looser ones."""

import pytest

import regrasp as rg

pytestmark = pytest.mark.contract

GRASP = rg.Grasp(
    [
        rg.Contact([-4, 0], normal=[1, 0], friction=0.6),
        rg.Contact([4, 0], normal=[-1, 0], friction=0.6),
        rg.Contact([0, -5], normal=[0, 1], friction=0.3),
    ]
)
LOAD = rg.Wrench([0.5, -3])
NEW = rg.Contact([0.5, -5], normal=[0, 1], friction=0.3, name="P4")


def planned(verb, two, three, **options):
    """With limits ``two`` for the state of two fingers, or the end, and ``three`` for the other."""
    rest = rg.Criteria("force", max_force=two)
    other = rg.Criteria("force", max_force=three)
    if verb == "removal":
        return rg.plan_removal(GRASP, "P3", load=LOAD, objective=rest, whole_objective=other, **options)
    if verb == "addition":
        two_fingers = GRASP.without("P3")
        return rg.plan_addition(
            two_fingers, GRASP["P3"], load=LOAD, objective=rest, whole_objective=other, **options
        )
    return rg.plan_exchange(GRASP, "P3", NEW, load=LOAD, objective=rest, start_objective=other, **options)


@pytest.mark.parametrize("verb", ["removal", "addition", "exchange"])
@pytest.mark.parametrize(("two", "three"), [(5.0, 9.0), (9.0, 5.0), (None, 5.0), (5.0, None)])
@pytest.mark.parametrize("options", [{}, {"path_objective": "change"}])
def test_each_end_keeps_its_own_limit(verb, two, three, options) -> None:
    plan = planned(verb, two, three, **options)
    assert rg.verify(plan).ok
    rest, other = (plan.start, plan.end) if verb == "addition" else (plan.end, plan.start)
    for state, limit in (rest, two), (other, three):
        if limit is not None:  # a squeeze goes up to its limit
            assert 0.9 * limit < state.magnitudes.max() <= limit
    loosest = None if None in (two, three) else max(two, three)
    assert {c.max_force for c in plan.grasp} == {loosest}


def test_a_limit_that_a_state_was_chosen_under_is_not_that_of_the_other_end() -> None:
    state = rg.choose_state(GRASP.without("P3"), LOAD, "force", max_force=5.0)
    whole = rg.Criteria("force", max_force=9.0)
    plan = rg.plan_addition(state, GRASP["P3"], whole_objective=whole)
    assert 8.1 < plan.end.magnitudes.max() <= 9.0
    assert plan.start.magnitudes.max() <= 5.0
    assert rg.plan_addition(state, GRASP["P3"]).peak <= 5.0


def test_the_path_keeps_the_least_reserve_of_its_ends() -> None:
    rest, whole = rg.Criteria("angle", reserve=0.2), rg.Criteria("friction_use", reserve=0.0)
    plan = rg.plan_removal(
        GRASP, "P3", load=LOAD, objective=rest, whole_objective=whole, path_objective="change"
    )
    assert plan.record.reserve == 0.0
    assert rg.verify(plan).ok
