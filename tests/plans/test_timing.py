"""The time function T(t) and the shortest duration under force-rate limits."""

from math import inf, nan

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import regrasp as rg
from regrasp import TimeScaling
from strategies import POWERS, points

pytestmark = pytest.mark.laws

PAPER = TimeScaling.spline(1.0)
JERK = TimeScaling.minimum_jerk(1.0)
LINEAR = TimeScaling.linear(1.0)
S = np.linspace(0, 1, 501)


@st.composite
def scalings(draw) -> TimeScaling:
    """Any falling control values, equal ones and jumps among them, and any degree."""
    inner = draw(st.lists(st.one_of(st.floats(0, 1), st.sampled_from([0.0, 0.5, 1.0])), max_size=6))
    control = (1.0, *sorted(inner, reverse=True), 0.0)
    degree = draw(st.integers(1, len(control) - 1))
    return TimeScaling(draw(st.floats(0.01, 100)), control, degree)


def de_boor(scaling: TimeScaling, s: float) -> float:
    """T at s = t / duration by the recursion of B-splines, from control values and degree only."""
    k, c = scaling.degree, list(scaling.control)
    pieces = len(c) - k
    knots = [0.0] * k + [i / pieces for i in range(pieces + 1)] + [1.0] * k
    j = min(int(s * pieces), pieces - 1) + k  # the piece: knots[j] <= s <= knots[j + 1]
    d = c[j - k : j + 1]
    for r in range(1, k + 1):
        for i in range(k, r - 1, -1):
            left, right = knots[i + j - k], knots[i + 1 + j - r]
            share = (s - left) / (right - left)
            d[i] = (1 - share) * d[i - 1] + share * d[i]
    return d[k]


# -- shapes in closed form --------------------------------------------------------------------------------


def test_the_papers_spline_is_a_cubic_step() -> None:
    """Knots 0 0 0 0 1/2 1 1 1 1, so T' has knots 0 0 0 1/2 1 1 1 and control values 0, -3/2, -3/2, 0.

    On both halves that is -6 s (1 - s): the two cubic pieces are one polynomial, T = 1 - 3 s^2 + 2 s^3.
    """
    np.testing.assert_allclose(PAPER(S), 1 - 3 * S**2 + 2 * S**3, rtol=0, atol=1e-15)
    np.testing.assert_allclose(PAPER.velocity(S), -6 * S * (1 - S), rtol=0, atol=1e-14)
    np.testing.assert_allclose(PAPER.acceleration(S), 12 * S - 6, rtol=0, atol=1e-13)
    assert PAPER.control == (1, 1, 0.5, 0, 0)
    assert PAPER.degree == 3


def test_minimum_jerk() -> None:
    np.testing.assert_allclose(JERK(S), 1 - 10 * S**3 + 15 * S**4 - 6 * S**5, rtol=0, atol=1e-14)
    np.testing.assert_allclose(JERK.velocity(S), -30 * S**2 * (1 - S) ** 2, rtol=0, atol=1e-14)
    np.testing.assert_allclose(JERK.velocity([0, 1]), 0, atol=1e-15)
    np.testing.assert_allclose(JERK.acceleration([0, 1]), 0, atol=1e-14)


def test_linear() -> None:
    np.testing.assert_allclose(LINEAR(S), 1 - S, rtol=0, atol=1e-16)
    np.testing.assert_array_equal(LINEAR.velocity(S), -1)
    np.testing.assert_array_equal(LINEAR.acceleration(S), 0)


@pytest.mark.parametrize("scaling", [PAPER, JERK, TimeScaling.spline(2.0, (1, 1, 0.9, 0.2, 0, 0))])
def test_zero_slope_at_both_ends(scaling: TimeScaling) -> None:
    assert scaling.velocity([0, scaling.duration]) == pytest.approx([0, 0], abs=1e-15)
    assert scaling.velocity(scaling.duration / 2) < -0.1 / scaling.duration


def test_fewer_control_values_give_a_lower_degree() -> None:
    assert [TimeScaling.spline(1, np.linspace(1, 0, k)).degree for k in (2, 3, 4, 5, 6)] == [1, 2, 3, 3, 3]


# -- laws ---------------------------------------------------------------------------------------------------


@given(scalings())
def test_falls_from_1_to_0(scaling: TimeScaling) -> None:
    values = scaling(scaling.duration * S)
    assert values[0] == 1
    assert values[-1] == 0
    assert values.min() >= -1e-15
    assert values.max() <= 1 + 1e-15
    assert (np.diff(values) <= 1e-15).all()
    assert (scaling.velocity(scaling.duration * S) <= 1e-12 / scaling.duration).all()


@given(scalings(), st.floats(0, 1))
def test_is_the_b_spline_of_its_control_values(scaling: TimeScaling, s: float) -> None:
    assert scaling(s * scaling.duration) == pytest.approx(de_boor(scaling, s), abs=1e-12)


@given(scalings(), st.floats(0.01, 0.99))
def test_derivatives_against_differences(scaling: TimeScaling, s: float) -> None:
    """Central differences, inside one polynomial piece."""
    pieces = len(scaling.control) - scaling.degree
    knot = round(s * pieces) / pieces
    h = min(1e-5, abs(s - knot) / 2) * scaling.duration
    if h < 1e-6 * scaling.duration:
        return
    t = s * scaling.duration
    ahead, behind = np.array([t + h]), np.array([t - h])
    rate = (scaling(ahead) - scaling(behind)) / (2 * h)
    bend = (scaling.velocity(ahead) - scaling.velocity(behind)) / (2 * h)
    size = float(scaling.degree * pieces) ** 2
    assert scaling.velocity(t) * scaling.duration == pytest.approx(
        rate[0] * scaling.duration, abs=1e-6 * size
    )
    square = scaling.duration**2
    assert scaling.acceleration(t) * square == pytest.approx(bend[0] * square, abs=1e-5 * size)


@given(scalings())
def test_steepest_is_the_largest_slope(scaling: TimeScaling) -> None:
    pieces = len(scaling.control) - scaling.degree
    knots = np.arange(pieces + 1) / pieces  # where T' may have a corner
    t = scaling.duration * np.concatenate([np.linspace(0, 1, 4001), knots])
    dense = float(abs(scaling.velocity(t)).max())
    assert dense <= scaling.steepest * (1 + 1e-12)
    # Within a piece T' bends by less than (2 degree pieces)^3, so between samples it rises this little above.
    rise = (2 * scaling.degree * pieces) ** 3 * 4000.0**-2
    assert scaling.steepest * scaling.duration <= dense * scaling.duration + rise


@pytest.mark.parametrize(("shape", "slope"), [(PAPER, 1.5), (JERK, 1.875), (LINEAR, 1.0)])
def test_steepest_of_known_shapes(shape: TimeScaling, slope: float) -> None:
    """6 s (1 - s) and 30 s^2 (1 - s)^2 are largest at s = 1/2: 3/2 and 15/8."""
    assert shape.steepest == pytest.approx(slope, rel=1e-15, abs=0)
    assert shape.lasting(0.02).steepest == pytest.approx(50 * slope, rel=1e-15, abs=0)
    assert abs(shape.velocity(S)).max() == pytest.approx(slope, rel=1e-14, abs=0)


def test_steepest_away_from_the_middle() -> None:
    """Control 1, 1, 1/4, 0: T' = -(4.5 s - 3.75 s^2), steepest at 0.6. Control 1, 1, 1, 0: T = 1 - s^3."""
    assert TimeScaling.spline(1.0, (1, 1, 0.25, 0)).steepest == pytest.approx(1.35, rel=1e-14, abs=0)
    assert TimeScaling.spline(1.0, (1, 1, 1, 0)).steepest == pytest.approx(3.0, rel=1e-14, abs=0)
    assert TimeScaling(1.0, (1, 1, 0.2, 0), 2).steepest == pytest.approx(
        1.6, rel=1e-14, abs=0
    )  # T' = 0, -1.6, -0.8


@given(scalings())
def test_reversed_is_the_motion_backwards(scaling: TimeScaling) -> None:
    t = scaling.duration * S
    back = scaling.reversed()
    np.testing.assert_allclose(back(t), 1 - scaling(t[-1] - t), rtol=0, atol=1e-12)
    assert back.duration == scaling.duration
    assert back.reversed().control == pytest.approx(scaling.control, abs=1e-15)
    assert back.steepest == pytest.approx(scaling.steepest, rel=1e-9)


@given(scalings(), st.floats(0.01, 100))
def test_lasting_stretches_time_only(scaling: TimeScaling, duration: float) -> None:
    other = scaling.lasting(duration)
    assert (other.duration, other.control, other.degree) == (duration, scaling.control, scaling.degree)
    np.testing.assert_allclose(other(duration * S), scaling(scaling.duration * S), rtol=0, atol=1e-12)
    assert other.steepest * duration == pytest.approx(scaling.steepest * scaling.duration, rel=1e-14, abs=0)


def test_times_have_any_shape() -> None:
    assert PAPER(0.5).shape == ()
    assert PAPER([[0.1, 0.2, 0.3]]).shape == (1, 3)
    assert PAPER.velocity(np.zeros((0,))).shape == (0,)


def test_scalings_compare_by_value() -> None:
    assert TimeScaling.spline(1.0) == TimeScaling(1.0, (1, 1, 0.5, 0, 0), 3)
    assert TimeScaling.spline(1.0) != TimeScaling.spline(2.0)
    assert repr(PAPER) == "TimeScaling(1 s, control=(1, 1, 0.5, 0, 0), degree 3)"


# -- the shortest duration (fact 6) -------------------------------------------------------------------------

changes = st.lists(points, min_size=1, max_size=5).filter(lambda rows: np.array(rows).any())


@given(changes, st.data(), scalings())
@settings(max_examples=200)
def test_fastest_reaches_a_limit_and_exceeds_none(
    change: list, data: st.DataObject, shape: TimeScaling
) -> None:
    rates = np.array([data.draw(st.one_of(st.floats(0.1, 50), st.just(inf))) for _ in change])
    moved = np.hypot(*np.array(change).T)
    if not (moved[np.isfinite(rates)] > 0).any():
        return
    found = TimeScaling.fastest(change, rates, shape)
    assert found.control == shape.control
    use = moved * found.steepest / rates
    assert use.max() == pytest.approx(
        1, rel=1e-14, abs=0
    )  # tight, and so shorter is too fast for some finger
    t = found.duration * np.linspace(0, 1, 1001)
    speed = abs(found.velocity(t))[:, None] * moved
    assert (speed <= rates * (1 + 1e-12)).all()


def test_fastest_by_hand() -> None:
    """|change| = 5, 1 N at 1.5 per unit time: 5 * 1.5 / 10 = 0.75 s; or 1 * 1.5 / 0.5 = 3 s."""
    change = [[3, 4], [0, -1]]
    assert TimeScaling.fastest(change, 10.0).duration == pytest.approx(0.75, rel=1e-15, abs=0)
    assert TimeScaling.fastest(change, [10.0, 0.5]).duration == pytest.approx(3.0, rel=1e-15, abs=0)
    assert TimeScaling.fastest(change, [inf, 0.5]).duration == pytest.approx(3.0, rel=1e-15, abs=0)
    assert TimeScaling.fastest(change, [10.0, inf]).duration == pytest.approx(0.75, rel=1e-15, abs=0)
    assert TimeScaling.fastest(change, 10.0, JERK).duration == pytest.approx(5 * 1.875 / 10, rel=1e-15, abs=0)
    assert TimeScaling.fastest(change, 10.0, LINEAR).duration == pytest.approx(0.5, rel=1e-15, abs=0)
    assert TimeScaling.fastest([[2, 3, 6]], 7.0, LINEAR).duration == pytest.approx(
        1.0, rel=1e-15, abs=0
    )  # in space
    assert TimeScaling.fastest(change, 10.0) == PAPER.lasting(TimeScaling.fastest(change, 10.0).duration)


@given(changes, POWERS, POWERS, st.floats(0.01, 100))
def test_fastest_in_any_units(change: list, force: float, time: float, duration: float) -> None:
    """Forces in ``force``, seconds in ``time``; the shape's own duration does not matter."""
    plain = TimeScaling.fastest(change, 2.0)
    scaled = TimeScaling.fastest(force * np.array(change), 2.0 * force / time, PAPER.lasting(duration))
    assert scaled.duration == pytest.approx(plain.duration * time, rel=1e-13, abs=0)


def test_fastest_transition_keeps_its_path() -> None:
    grasp = rg.Grasp(
        [
            rg.Contact([-4, -4], [1, 1], 0.3),
            rg.Contact([4, -5], [-1, 2], 0.3),
            rg.Contact([0, 8], [0, -1], 0.3),
        ]
    )
    removal = rg.plan_removal(grasp, "P3", load=rg.Wrench([-1.5, -3.5]), duration=7.0)
    limits = np.array([3.0, 2.0, 4.0])
    quick = removal.fastest(limits)
    assert quick.duration < 7.0
    assert (quick.start, quick.end) == (removal.start, removal.end)
    rates = np.linalg.norm(quick.rates(np.linspace(0, quick.duration, 2001)), axis=-1)
    assert (rates.max(axis=0) / limits).max() == pytest.approx(1, rel=1e-14, abs=0)
    half = quick.duration / 2
    np.testing.assert_allclose(quick.forces(half), removal.forces(3.5), rtol=1e-14)
    step = 1e-6 * quick.duration
    slope = (quick.forces(half + step) - quick.forces(half - step)) / (2 * step)
    np.testing.assert_allclose(quick.rates(half), slope, rtol=1e-6, atol=1e-8)


# -- errors -------------------------------------------------------------------------------------------------

FALL = "control values must fall from 1 to 0"
ENDLESS = "no force that changes has a rate limit, so no shortest duration follows"
BAD = [
    (lambda: TimeScaling(0.0, (1, 0), 1), "duration must be greater than 0, got 0.0"),
    (lambda: TimeScaling(nan, (1, 0), 1), "duration must be finite, got nan"),
    (lambda: TimeScaling.spline("soon"), "duration must be a number, got 'soon'"),
    (lambda: TimeScaling.spline(1.0, (1, 0.2, 0.5, 0)), f"{FALL}, got (1.0, 0.2, 0.5, 0.0)"),
    (lambda: TimeScaling.spline(1.0, (0.9, 0)), f"{FALL}, got (0.9, 0.0)"),
    (lambda: TimeScaling.spline(1.0, (1, 0.1)), f"{FALL}, got (1.0, 0.1)"),
    (lambda: TimeScaling.spline(1.0, (1,)), f"{FALL}, got (1.0,)"),
    (lambda: TimeScaling.spline(1.0, (1, nan, 0)), "control value must be finite, got nan"),
    (lambda: TimeScaling(1.0, (1, 0.5, 0), 3), "degree must be from 1 to 2, got 3"),
    (lambda: TimeScaling(1.0, (1, 0.5, 0), 0), "degree must be from 1 to 2, got 0"),
    (lambda: PAPER(1.5), "t must lie in [0, 1] s, got 1.5"),
    (lambda: PAPER.velocity([-1e-9, 0.5]), "t must lie in [0, 1] s, got [-1e-09, 0.5]"),
    (lambda: PAPER.acceleration(nan), "t must lie in [0, 1] s, got nan"),
    (lambda: PAPER("noon"), "t must be numbers, got 'noon'"),
    (lambda: PAPER.lasting(-1), "duration must be greater than 0, got -1"),
    (lambda: TimeScaling.fastest([[1, 0]], 0.0), "rate_limit must be greater than 0, got 0.0"),
    (lambda: TimeScaling.fastest([[1, 0]], nan), "rate_limit must be greater than 0, got nan"),
    (lambda: TimeScaling.fastest([[1, 0]], [1, 2]),
     "rate_limit must be a number or have shape (1,), got [1, 2]"),
    (lambda: TimeScaling.fastest([1, 0], 1.0), "change must have shape (any, any), got (2,): [1, 0]"),
    (lambda: TimeScaling.fastest([[0, 0]], 1.0), ENDLESS),
    (lambda: TimeScaling.fastest([[1, 0]], inf), ENDLESS),
]  # fmt: skip


@pytest.mark.parametrize(("call", "message"), BAD, ids=[message for _, message in BAD])
def test_bad_input_is_refused(call, message: str) -> None:
    with pytest.raises(rg.InvalidInput) as refused:
        call()
    assert str(refused.value) == message
