"""|f_i'(t)| of straight paths, |f_i^A - f_i^B| max|T'|, judged at its limit on both sides."""

from dataclasses import dataclass
from math import inf

import numpy as np
import pytest

import regrasp as rg
from foreign import Plan, Record, Scaling, cross
from regrasp.plans import record as rg_record
from regrasp.plans.timing import TimeScaling
from regrasp.verification.falling import steepest

pytestmark = pytest.mark.contract


@dataclass(frozen=True)
class Spline(Scaling):
    degree: float = 1


def ends() -> tuple[rg.GraspState, rg.GraspState]:
    grasp, forces = cross((0.75,) * 4)
    forces[:, 1:] = 0
    load = rg.Wrench([0, 0])
    return rg.GraspState(grasp, load, forces), rg.GraspState(grasp, load, 3 * forces)


def said(limits, scaling=None, **changes) -> str:
    start, end = ends()
    more = {} if scaling is None else {"scaling": scaling}
    plan = Plan("rotation", None, start, end, record=Record(rate_limits=limits), **more, **changes)
    return "; ".join(rg.verify(plan).violations)


@pytest.mark.parametrize(
    ("control", "degree", "slope"),
    [
        ((1.0, 0.0), 1, 1.0),
        ((1.0, 1.0, 0.5, 0.0, 0.0), 3, 1.5),
        ((1.0, 1.0, 1.0, 0.0, 0.0, 0.0), 5, 1.875),
        ((1.0, 1.0, 0.25, 0.0), 3, 1.35),
    ],
)
def test_limits_are_kept_to_the_last_digits(control, degree, slope) -> None:
    start, end = ends()
    moved = np.linalg.norm(end.forces - start.forces, axis=1)
    scaling = Spline(2.0, control, degree)
    for i, name in enumerate(start.grasp.names):
        limits = [inf] * 4
        limits[i] = float(moved[i] * slope / 2.0)
        if moved[i] == 0:
            continue
        assert said(tuple(limits), scaling) == ""
        limits[i] *= 1 - 1e-11
        assert said(tuple(limits), scaling).startswith(f"{name} changes faster than")


def test_nothing_is_promised_of_turns_nor_where_time_runs_wrong() -> None:
    assert said((inf,) * 4) == ""
    for control, degree in (((1.0, 0.5, 0.0), 3), ((1.0, 0.0), 0), ((1.0, 0.0), 0.5)):
        assert "degree" in said((1e9,) * 4, Spline(1.0, control, degree))


def test_steepest_of_plans_is_the_verifiers() -> None:
    """Degrees to 20, where FITPACK ends at 5, equal control values, digits few and many."""
    rng = np.random.default_rng(5)
    for _ in range(40):
        count = int(rng.integers(2, 24))
        inner = rng.random(count - 2).round(int(rng.integers(1, 17)))
        control = np.sort([1.0, *inner, 0.0])[::-1]
        scaling = TimeScaling(1.0, tuple(control), int(rng.integers(1, min(count, 21))))
        proven = float(steepest(scaling))
        assert scaling.steepest == pytest.approx(proven, rel=1e-12, abs=0)
        dense = abs(scaling.velocity(np.linspace(0, 1, 501))).max()
        assert dense * (1 - 1e-12) <= proven


def test_plans_remember_rates_until_they_are_retimed() -> None:
    start, end = ends()
    plan = rg.Transition(start, end, TimeScaling.spline(1.0), rg_record.Record(0.0)).fastest([4, inf, 5, 6])
    assert plan.record.rate_limits == (4, inf, 5, 6)
    assert rg.verify(plan).ok
    assert np.max(plan.steepest / [4, inf, 5, 6]) == pytest.approx(1)
    slower = plan.retimed(TimeScaling.linear(9.0))
    assert slower.record.rate_limits == ()
    assert rg.Transition.from_dict(plan.to_dict()) == plan
