"""What ``verify`` finds in records of plain values: least normal forces, rates, limits, claims."""

from dataclasses import replace
from math import inf, nan, nextafter
from types import SimpleNamespace

import numpy as np
import pytest

import regrasp as rg
from foreign import EPS, Plan, Record, course, cross, places, said
from foreign.crosses import CROSSES, FINGERS, UPPER, WHOLE

pytestmark = pytest.mark.contract


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
@pytest.mark.parametrize("finger", range(4))
def test_least_normal_forces_at_their_limit(make, finger) -> None:
    """Fingers push with 1 (5/4 in space), everywhere; the record allows the last 2^-40 for rounding."""
    grasp, forces = make()
    push = abs(forces[finger, 0])
    for least, good in (
        (0.0, True), (push, True), (push * (1 + 0.99 * EPS), True), (push * (1 + 1.01 * EPS), False),
        (2 * push, False),
    ):  # fmt: skip
        limits = [0.0] * 4
        limits[finger] = least
        for where, plan in places(grasp, forces):
            found = said(replace(plan, record=Record(least_normals=tuple(limits))))
            assert (found == "") == good, (where, least)
            assert good or found.startswith(f"{'ABCD'[finger]} pushes with {push:g} along its normal, below ")


def test_least_normal_forces_are_looked_for_in_every_state() -> None:
    """One state pushes with 1, the others with 2."""
    from foreign import spoilt

    grasp, forces = cross()
    for where, plan in places(grasp, 2 * forces):
        demanding = replace(plan, record=Record(least_normals=(1.5,) * 4))
        assert said(demanding) == ""
        for at in ("start", "end") if where == "ends" else (where,):
            assert "pushes with 1 along its normal, below 1.5" in said(spoilt(demanding, at, forces))


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("stretch", [0, 1])
def test_rates_at_their_limit(sign, stretch) -> None:
    """All fingers grow, or fade, by 1 along the normal in half a second: 2 N/s on one stretch."""
    forces = WHOLE.forces
    first, last = (1.0, 2.0)[::sign]
    sizes = [first, *[(last, first)[stretch]], last]
    start, end = (rg.GraspState(WHOLE.grasp, WHOLE.load, size * forces) for size in (first, last))
    for finger in range(4):
        for limit, good in (
            (2.0, True),
            (2 / (1 + 0.99 * EPS), True),
            (2 / (1 + 1.01 * EPS), False),
            (1.0, False),
        ):
            rates = [inf] * 4
            rates[finger] = limit
            plan = Plan(
                "rotation", None, start, end, record=Record(rate_limits=tuple(rates)),
                course=course([0, 0.5, 1], [size * forces for size in sizes], [[0, 0, 0]] * 3),
            )  # fmt: skip
            found = said(plan)
            assert (found == "") == good
            assert (
                good
                or found == f"{'ABCD'[finger]} changes faster than {limit:.9g} after t = {stretch / 2:g} s"
            )


@pytest.mark.parametrize("make", CROSSES.values(), ids=CROSSES)
def test_rates_across_the_normals(make) -> None:
    """Tangential forces fade: 1/2 in the plane, (3/8, 1/2) of length 5/8 in space, in a second."""
    grasp, forces = make((0.75,) * 4)
    load = rg.Wrench([0.0] * grasp.dimension)
    bent = forces.copy()
    bent[:, 1:] = 0
    start, end = (rg.GraspState(grasp, load, f) for f in (forces, bent))
    size = 0.5 if grasp.dimension == 2 else 0.625
    for limit, good in (size, True), (size * (1 - 1e-9), False):
        record, path = Record(rate_limits=(limit,) * 4), course([0, 1], [forces, bent], [load.vector] * 2)
        assert (said(Plan("rotation", None, start, end, record=record, course=path)) == "") == good


def test_rates_are_those_of_forces_without_torques() -> None:
    """A soft pair whose torques change by 1 and whose pushes by 1/2 in a second."""
    grasp = rg.Grasp(rg.Contact([x, 0, 0], [-x, 0, 0], 0.5, torsion=1.0) for x in (-1, 1))
    first, last = np.array([[4, 0, 0, 0.0], [-4, 0, 0, 0.0]]), np.array([[4.5, 0, 0, 1.0], [-4.5, 0, 0, 1.0]])
    start, end = (rg.GraspState(grasp, rg.Wrench([0, 0, 0]), f) for f in (first, last))
    path = course([0, 1], [first, last], [[0.0] * 6] * 2)
    for limit, good in (0.5, True), (0.499, False):
        plan = Plan("rotation", None, start, end, record=Record(rate_limits=(limit,) * 2), course=path)
        assert (said(plan) == "") == good


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"reserve": 0.0}, ""),
        ({"reserve": nextafter(1, 0)}, ""),
        ({"reserve": 1.0}, "reserve is 1, not a fraction"),
        ({"reserve": -5e-324}, "not a fraction"),
        ({"reserve": -1.0}, "reserve is -1, not a fraction"),
        ({"reserve": 1e300}, "reserve is 1e+300, not a fraction"),
        ({"reserve": nan}, "reserve is nan"),
        ({"balancing": 1e300}, ""),
        ({"balancing": -5e-324}, "which is no change of a force"),
        ({"balancing": inf}, "which is no change of a force"),
        ({"balancing": nan}, "which is no change of a force"),
        ({"rate_limits": (inf,) * 3}, "4 contacts need as many rate limits or none, got 3"),
        ({"rate_limits": (inf,) * 5}, "4 contacts need as many rate limits or none, got 5"),
        ({"rate_limits": (inf, inf, 0.0, inf)}, "every rate limit must be greater than 0"),
        ({"rate_limits": (inf, inf, nan, inf)}, "every rate limit must be greater than 0"),
        ({"least_normals": (0.0,) * 4}, ""),
        ({"least_normals": (0.0,) * 5}, "4 contacts need as many least normal forces or none, got 5"),
        ({"least_normals": (0.0, 0.0, -5e-324, 0.0)}, "every least normal force must be at least 0"),
        ({"least_normals": (0.0, nan, 0.0, 0.0)}, "every least normal force must be at least 0"),
        ({"least_normals": (0.0, inf, 0.0, 0.0)}, "every least normal force must be a number"),
    ],
)
def test_records_of_impossible_numbers(changes, words) -> None:
    found = said(Plan(*FINGERS, record=Record(**changes)))
    assert words in found
    assert bool(words) == bool(found)


def chosen(end="end", limits=(1.0, 1.0, 1.0)) -> tuple:
    return (SimpleNamespace(end=end, objective="angle", method="clarabel", force_limits=limits),)


@pytest.mark.parametrize(
    ("end", "limits", "words"),
    [
        ("end", (1.0,) * 3, ""),
        ("end", (inf,) * 3, ""),
        ("start", (1.0,) * 4, ""),
        ("end", (1 / (1 + 0.99 * EPS), 1.0, 1.0), ""),
        ("end", (1 / (1 + 1.01 * EPS), 1.0, 1.0), "end was chosen with forces of A up to 1, it has 1"),
        ("end", (1.0, 0.9, 1.0), "end was chosen with forces of C up to 0.9, it has 1"),
        ("start", (1.0, 0.9, 1.0, 1.0), "start was chosen with forces of B up to 0.9, it has 1"),
        ("end", (1.0,) * 4, "3 fingers in use, but 4 force limits"),
        ("start", (1.0,) * 3, "4 fingers in use, but 3 force limits"),
        ("end", (1.0, -1.0, 1.0), "force limits must be greater than 0"),
        ("end", (1.0, 0.0, 1.0), "force limits must be greater than 0"),
        ("end", (1.0, nan, 1.0), "force limits must be greater than 0"),
        ("middle", (1.0,) * 3, "chosen for 'middle', which is neither start nor end"),
    ],
)
def test_limits_that_states_were_chosen_under(end, limits, words) -> None:
    found = said(Plan(*FINGERS, record=Record(choices=chosen(end, limits))))
    assert words in found
    assert bool(words) == bool(found)


def test_verdicts_say_what_is_proven() -> None:
    plan = Plan(*FINGERS)
    measured = rg.verify(plan, lambda t: WHOLE.load)
    assert not measured.load_gap_is_proven
    assert "measured between instants, not proven" in str(measured)
    proven = rg.verify(plan, lambda t: WHOLE.load, curvature=0.0)
    assert proven.load_gap_is_proven
    assert "(proven)" in str(proven)
    assert (measured.load_gap, proven.load_gap) == (0.0, 0.0)
    wrong = Plan("removal", "E", WHOLE, UPPER)
    assert str(rg.verify(wrong)).startswith("not verified:\n  contact 'E' is not one of")
    assert rg.verify(plan).load_gap is None
