"""The picture of tolerances shows the numbers of the value."""

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
    assert found._repr_png_()[:4] == b"\x89PNG"
