"""The polar picture of held directions shows the exact arc and the margins of chosen states."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import regrasp as rg
from drawn import by_gid
from paper import GRASP
from regrasp import plots

pytestmark = pytest.mark.contract

PAIR = GRASP.subset(["P1", "P2"])


@pytest.mark.parametrize("objective", ["angle", "force"])
@pytest.mark.parametrize("grasp", [PAIR, GRASP], ids=["pair", "three"])
def test_margins_are_those_of_chosen_states(grasp, objective):
    ax = plots.plot_directions(grasp, 3.8, objective=objective)
    (line,) = by_gid(ax, "margin")
    angles, values = line.get_data()
    held = rg.held_directions(grasp)
    assert (angles[0], angles[-1]) == held.arc
    assert values.max() > 0
    for angle, value in list(zip(angles, values, strict=True))[2:-2:7]:
        state = rg.choose_state(grasp, rg.Wrench([3.8 * np.cos(angle), 3.8 * np.sin(angle)]), objective)
        expected = (
            np.degrees(state.margins.least_angle) if objective == "angle" else state.margins.least_force
        )
        assert value == pytest.approx(expected, abs=1e-6)
    assert len(by_gid(ax, "held")) == 1
    ends = sorted(float(artist.get_xdata()[0]) for artist in by_gid(ax, "end of arc"))
    assert ends == ([] if held.kind == "everything" else sorted(held.arc))
    assert values.max() <= ax.get_rmax()


def test_units_and_degenerate_grasps():
    ax = plots.plot_directions(PAIR, 2.0, objective="force", units=plots.Units("mm", "kN"))
    assert "[kN]" in ax.get_legend().get_texts()[0].get_text()
    shelf = rg.Grasp([rg.Contact([-1, -1], [0, 1], 0.0), rg.Contact([1, -1], [0, 1], 0.0)])
    ax = plots.plot_directions(shelf, 1.0, objective="force")
    assert not by_gid(ax, "held")
    (end,) = by_gid(ax, "end of arc")
    assert end.get_xdata()[0] == pytest.approx(-np.pi / 2)
    beside = rg.Grasp([rg.Contact([1, -1], [0, 1], 0.0), rg.Contact([2, -1], [0, 1], 0.0)])
    ax = plots.plot_directions(beside, 1.0)
    assert not by_gid(ax, "margin")
    assert "no direction" in ax.texts[0].get_text()
    ax.figure.canvas.draw()


def test_bad_input():
    with pytest.raises(rg.InvalidInput, match="ax must be polar"):
        plots.plot_directions(PAIR, 1.0, Figure().add_subplot())
    with pytest.raises(rg.InvalidInput, match="load_size must be greater than 0"):
        plots.plot_directions(PAIR, 0.0)
    with pytest.raises(rg.InvalidInput, match="objective must be one of"):
        plots.plot_directions(PAIR, 1.0, objective="peak")
    with pytest.raises(rg.InvalidInput, match="this picture is of the plane"):
        plots.plot_directions(rg.Grasp([rg.Contact([0, 0, 1], [0, 0, -1], 0.5)]), 1.0)
