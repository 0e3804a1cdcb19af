"""Curves of the best margin: points are states chosen one by one, chords are on the safe side."""

from math import inf

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from regrasp import plots
from values import WEIGHT, space_grasp

pytestmark = pytest.mark.laws


@pytest.mark.parametrize("objective", ["force", "wrench", "angle"])
def test_margins_over_limits_rise_and_chords_suffice(objective: str) -> None:
    two = GRASP.without("P3")
    curve = rg.margin_curve(two, LOAD, objective=objective, count=9)
    peak = rg.choose_state(two, LOAD, "peak").value
    assert curve.at[0] == pytest.approx(peak, rel=1e-5)
    assert (np.diff(curve.values) > -1e-7).all()
    for k in (2, 7):
        alone = rg.choose_state(two, LOAD, objective, max_force=float(curve.at[k]))
        assert curve.values[k] == pytest.approx(alone.value, rel=1e-6)
    if objective == "angle":
        return
    slopes = np.diff(curve.values) / np.diff(curve.at)
    assert (np.diff(slopes) < 1e-6 * abs(slopes).max()).all()  # concave
    wanted = 0.5 * (curve.values[0] + curve.values[1])
    limit = curve.least(wanted)
    assert curve.at[0] < limit < curve.at[1]
    assert rg.choose_state(two, LOAD, objective, max_force=limit).value >= wanted
    assert curve.least(1e9) == inf
    assert curve.least(-1e9) == curve.at[0]


def test_over_friction_it_starts_at_the_least_that_holds() -> None:
    least = rg.least_friction(GRASP, LOAD).value / 0.3
    curve = rg.margin_curve(GRASP, LOAD, "friction", at=[0.99 * least, 1.01 * least, 1.0, 2.0])
    assert np.isnan(curve.values[0])
    assert curve.states[0] is None
    assert curve.values[1] < curve.values[2] < curve.values[3]


def test_over_places_a_contact_moves_and_its_normal_turns() -> None:
    flat = rg.margin_curve(GRASP, LOAD, "position", "angle", contact="P3", at=[-0.5, 0.0, 0.5])
    bent = rg.margin_curve(GRASP, LOAD, "position", "angle", contact="P3", surface=0.5, at=[-0.5, 0.0, 0.5])
    assert flat.contact == "P3"
    here = rg.choose_state(GRASP, LOAD, "angle").value
    assert flat.values[1] == bent.values[1] == pytest.approx(here)
    assert flat.states[2].grasp["P3"].position.tolist() == [0.5, 8.0]
    assert bent.states[2].grasp["P3"].normal @ [0, -1] == pytest.approx(np.cos(0.25))
    space = rg.margin_curve(space_grasp(), WEIGHT, "position", "force", contact=0, count=3, max_force=20.0)
    assert np.isfinite(space.values).all()


def test_what_makes_no_curve_is_refused() -> None:
    with pytest.raises(rg.InvalidInput, match="contact says which one x='position' moves"):
        rg.margin_curve(GRASP, LOAD, "position")
    with pytest.raises(rg.InvalidInput, match=r"give at=\[...\]"):
        rg.margin_curve(GRASP, rg.Wrench([0, 0]))
    with pytest.raises(rg.Infeasible):
        rg.margin_curve(GRASP.without("P1"), LOAD)


def test_the_picture_shows_the_least_force_for_a_margin() -> None:
    curve = rg.margin_curve(GRASP.without("P3"), LOAD, count=5)
    ax = plots.plot_margin_curve(curve, at_value=float(curve.values[2]))
    np.testing.assert_allclose(ax.lines[0].get_xdata(), curve.at)
    assert any(f"{curve.least(float(curve.values[2])):.3g}" in text.get_text() for text in ax.texts)
    over = plots.plot_margin_curve(rg.margin_curve(GRASP, LOAD, "friction", "angle", count=5))
    assert "deg" in over.get_ylabel()
    assert "factor on friction" in over.get_xlabel()
