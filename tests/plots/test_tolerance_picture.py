"""The picture of tolerances shows the numbers of the value."""

import numpy as np
import pytest

import regrasp as rg
from paper import GRASP, LOAD
from regrasp import plots

pytestmark = pytest.mark.contract


def test_bars_are_shares_of_what_can_be_answered() -> None:
    found = rg.tolerances(rg.choose_state(GRASP.without("P3"), LOAD, "force", max_force=12.0))
    ax = plots.plot_tolerances(found, units=plots.Units("mm", "N", "s"))
    bars = {bar.get_gid(): bar.get_width() for bar in ax.patches if bar.get_gid()}
    mine, other = found.withstood, found.answered
    assert bars["tilt"] == pytest.approx(mine.tilt / other.tilt)
    assert bars["friction"] == pytest.approx((1 - mine.friction) / (1 - other.friction))
    assert bars["load"] == 0  # what can be answered has no end
    assert bars["position P2"] == pytest.approx(mine.position[1] / other.position[1])
    words = [text.get_text() for text in ax.texts]
    assert f"{mine.centre:.3g} mm  |  {other.centre:.3g} mm" in words


def test_a_set_of_loads_is_drawn_as_its_shadow() -> None:
    load = rg.Wrench([0, -3.0], 0.2)
    for loads in (
        rg.LoadSet.ball(load, force=0.8, torque=0.3),
        rg.LoadSet.tilted(load, 0.5),
        rg.LoadSet.hull([load, rg.Wrench([1, -2]), rg.Wrench([-1, 1], 2)]),
    ):
        for names, places in ((("fx", "fy"), [0, 1]), (("torque", "fx"), [2, 0])):
            ax = plots.plot_load_set(loads, components=names, label="set")
            rim = next(line for line in ax.lines if line.get_gid() == "load set rim").get_xydata()
            for y in np.random.default_rng(0).normal(size=(30, 2)):
                twist = np.zeros(3)
                twist[places] = y
                most = float(loads.support(twist))
                assert (rim @ y).max() == pytest.approx(most, rel=1e-4, abs=1e-4)
                assert (rim @ y).max() <= most + 1e-12 * (1 + abs(most))
    with pytest.raises(rg.InvalidInput, match="components must be two of fx, fy, torque"):
        plots.plot_load_set(loads, components=("fx", "fz"))


def test_linear_limits_are_drawn_along_the_force() -> None:
    contact = GRASP["P1"].changed(limits=([[1.0, 0.0]], [6.0]))
    plan = rg.plan_removal(GRASP.replaced("P1", contact), "P3", load=LOAD)
    ax = plots.plot_magnitudes(plan)
    line = next(line for line in ax.lines if line.get_gid() == "linear limit P1")
    forces = plan.forces(line.get_xdata())[:, 0]
    reach = 6.0 * np.linalg.norm(forces, axis=1) / (forces @ contact.normal)
    np.testing.assert_allclose(line.get_ydata(), reach, rtol=1e-9)
