"""Our splines against those of SciPy."""

import numpy as np
import pytest
from scipy.interpolate import BSpline, CubicSpline

import regrasp as rg
from regrasp.mechanics.splines.clamped import ClampedSpline
from regrasp.mechanics.splines.periodic import PeriodicSpline

pytestmark = pytest.mark.oracle


@pytest.mark.parametrize("count", [3, 4, 24, 300])
def test_values_and_derivatives_are_those_of_scipy(count):
    rng = np.random.default_rng(count)
    breaks = np.concatenate([[0.0], np.cumsum(rng.uniform(0.1, 10, count))])
    values = rng.normal(size=(count, 2))
    ours = PeriodicSpline(breaks, values)
    theirs = CubicSpline(breaks, np.vstack([values, values[:1]]), bc_type="periodic")
    period = breaks[-1]
    u = np.concatenate([rng.uniform(-period, 2 * period, 400), breaks, [-period, 2 * period]])
    for order in range(3):
        assert ours(u, order) == pytest.approx(theirs(u, order), rel=1e-12, abs=1e-12)
        inside = u.reshape(-1, 1)[:5]
        assert ours(inside, order).shape == (5, 1, 2)
    assert (ours(breaks[:-1]) == values).all()


@pytest.mark.parametrize("degree", [1, 2, 3, 5])
def test_clamped_splines_are_those_of_scipy(degree):
    rng = np.random.default_rng(degree)
    control = np.sort(rng.random(degree + 4))[::-1]
    knots = np.concatenate([np.zeros(degree), np.linspace(0, 1, 5), np.ones(degree)])
    ours, theirs = ClampedSpline(knots, control, degree), BSpline(knots, control, degree)
    s = np.concatenate([rng.random(300), np.unique(knots)])
    for _ in range(degree + 1):
        assert ours(s) == pytest.approx(theirs(s), rel=1e-12, abs=1e-12)
        assert ours(s[:4].reshape(2, 2)).shape == (2, 2)
        if not ours.degree:
            break
        ours, theirs = ours.derivative(), theirs.derivative()
    assert (ours.derivative()(s) == 0).all()


@pytest.mark.parametrize(
    "control", [(1, 1, 0.5, 0, 0), (1, 0.9, 0.9, 0.3, 0.2, 0), (1, 1, 0.2, 0.2, 0.1, 0, 0)]
)
def test_the_steepest_instant_is_found(control):
    for degree in range(1, 5):
        scaling = rg.TimeScaling(2.0, control, degree)
        t = np.linspace(0, 2.0, 200_001)
        sampled = abs(scaling.velocity(t)).max()
        assert sampled <= scaling.steepest * (1 + 1e-12)
        assert sampled == pytest.approx(scaling.steepest, rel=1e-6)
