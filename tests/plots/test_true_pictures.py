"""Pictures tell the truth: outlines, limits, proportions, constants, several plans on one axes."""

import re

import numpy as np
import pytest
from matplotlib.patches import PathPatch

import regrasp as rg
from paper import GRASP, LOAD, STATE
from regrasp import plots
from regrasp.mesh import Mesh
from regrasp.plots.look.arrows import Arrow3D

pytestmark = pytest.mark.contract

BAR = rg.Outline([[-0.3, -0.01], [0.3, -0.01], [0.3, 0.01], [-0.3, 0.01]])
ON_BAR = rg.Grasp(BAR.contact_at(s, friction=0.5, name=f"P{s}") for s in (0.15, 0.45, 0.92))


@pytest.fixture(scope="module")
def removal():
    return rg.plan_removal(STATE, "P3")


def artists(ax, gid):
    return [a for a in ax.get_children() if str(a.get_gid() or "").startswith(gid)]


def test_a_known_outline_is_drawn_and_arrows_are_no_longer_than_it_is_wide():
    state = rg.choose_state(ON_BAR, rg.Wrench([0, -1.0]))
    ax = plots.plot_state(state, outline=BAR)
    (body,) = artists(ax, "body")
    assert isinstance(body, PathPatch)
    np.testing.assert_allclose(np.ptp(body.get_path().vertices, axis=0), [0.6, 0.02])
    longest = max(np.ptp(line.get_path().vertices[:, 1]) for line in artists(ax, "cone"))
    assert longest <= 0.02
    with pytest.raises(rg.InvalidInput, match="outline must be"):
        plots.plot_state(state, outline=3)
    figures = plots.figures(rg.plan_removal(ON_BAR, 2, load=rg.Wrench([0, -1.0])), outline=BAR)
    for stem in ("overview", "states", "object"):
        assert artists(figures[stem].axes[0], "body"), stem


def test_arrows_in_space_are_no_longer_than_a_slender_part_is_wide():
    rod = Mesh.box(0.3, 0.02, 0.02)
    places = [[-0.05, 0.01, 0.001], [0.05, 0.01, 0], [0.06, -0.01, 0], [-0.06, -0.01, 0.001]]
    grasp = rg.Grasp(rod.contact_at(place, friction=0.6) for place in places)
    state = rg.choose_state(grasp, rg.Wrench([0, 0, -2.0]), "effort")
    ax = plots.plot_state(state, mesh=rod)
    arrows = [a for a in ax.get_children() if isinstance(a, Arrow3D)]
    lengths = [np.linalg.norm(np.diff(a.ends, axis=0)) for a in arrows]
    assert len(lengths) == 5
    assert max(lengths) <= 0.02 * (1 + 1e-9)


def test_force_limits_are_drawn_where_they_are_near(removal):
    given = rg.plan_removal(STATE, "P3", end=removal.end.without("P3"))
    assert artists(plots.plot_magnitudes(given), "limit") == [], "nothing was chosen, no finger has a limit"
    tight = rg.Grasp([*GRASP.contacts[:2], rg.Contact([0, 8], [0, -1], 0.3, max_force=9.0, name="P3")])
    ax = plots.plot_magnitudes(rg.plan_removal(tight, "P3", load=LOAD))
    (line,) = artists(ax, "limit P3")
    assert line.get_ydata()[0] == pytest.approx(9.0, rel=0.2)
    assert line.get_ydata()[0] <= 9.0


def test_rate_limits_are_drawn_in_figures_and_pages(tmp_path):
    bent = rg.plan_removal(STATE, "P3", duration=1.0, rate_limit=5.0)
    ax = plots.plot_rates(bent)
    (line,) = artists(ax, "limit")
    assert line.get_ydata()[0] == 5.0
    assert max(np.max(each.get_ydata()) for each in ax.get_lines()) <= 5.0 * (1 + 1e-9)
    page = tmp_path / "bent.html"
    plots.html(bent, page)
    assert '"rate_limit":5.0' in page.read_text(encoding="utf-8").replace(" ", "")
    assert artists(plots.plot_rates(bent, rate_limit=[5, 6, 1e9]), "limit P3") == [], "far above"


def test_two_plans_on_one_axes_keep_their_own_limits(removal):
    longer = rg.plan_removal(STATE, "P3", duration=2.0, objective="effort")
    ax = plots.plot_margins(removal)
    plots.plot_margins(longer, ax=ax)
    assert [text.get_text() for text in ax.get_legend().get_texts()] == ["P1", "P2", "P3"]
    least = artists(ax, "least")
    assert [line.get_xdata()[1] for line in least] == [1.0, 2.0]
    assert ax.get_xlim()[1] == 2.0
    low, high = ax.get_ylim()
    for line in ax.get_lines():
        values = np.asarray(line.get_ydata())
        assert low <= np.nanmin(values)
        assert np.nanmax(values) <= high


def test_what_is_constant_looks_constant():
    still = rg.Transition(
        STATE.balanced(), STATE.balanced(), rg.TimeScaling.linear(1.0), rg.plan_removal(STATE, "P3").record
    )
    ax = plots.plot_wrench_components(still, "P3")
    for axes in ax.figure.axes:
        values = np.concatenate([np.asarray(line.get_ydata(), dtype=float) for line in axes.get_lines()])
        low, high = axes.get_ylim()
        assert high - low >= 0.1 * np.abs(values).max()


def test_a_regrasp_says_its_scale_of_force(removal):
    ax = plots.plot_regrasp(rg.RegraspPlan((removal,), (0.0, 0.0), 0.0)).axes[0]
    bar = next(line for line in ax.get_lines() if line.get_gid() == "scale")
    words = next(text.get_text() for text in ax.texts if text.get_gid() == "scale name")
    (load,) = artists(ax, "load")
    tail, head = load._posA_posB  # of the arrow, as it was given
    scale = np.hypot(*np.subtract(head, tail)) / np.hypot(1.5, 3.5)
    assert float(np.ptp(bar.get_xdata())) == pytest.approx(scale * float(words.split()[0]))


def test_grasps_loci_verdicts_and_tolerances_are_tables_in_notebooks(removal):
    cells = re.findall(r"<td>(.*?)</td>", GRASP._repr_html_())
    assert cells[:3] == ["P1", "\N{MINUS SIGN}4", "\N{MINUS SIGN}4"]
    assert len(cells) == 3 * 7
    locus = rg.EquilibriumLocus(GRASP.without("P3"), LOAD)
    cells = re.findall(r"<td>(.*?)</td>", locus._repr_html_())
    assert [cells[1], cells[11]] == [f"{x:.5g}" for x in locus.interval]
    least = float(cells[4].replace("\N{MINUS SIGN}", "-"))
    assert least == pytest.approx(0, abs=1e-9)
    far = rg.EquilibriumLocus(
        rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5), rg.Contact([1, 0], [-1, 0], 0.5)]), LOAD
    )
    assert "without end" in far._repr_html_()
    assert "no forces inside" in rg.EquilibriumLocus(GRASP.without("P1"), LOAD)._repr_html_()
    assert "<th>verified</th>" in rg.verify(removal)._repr_html_()
    assert "NOT verified" in rg.Verification(("P1 slips",), 0.0, 0.1, -0.1)._repr_html_()
    found = rg.tolerances(removal)
    cells = re.findall(r"<td>(.*?)</td>", found._repr_html_())
    assert cells[:2] == ["friction", f"{found.withstood.friction:.5g}"]
    assert "answered" not in vars(found), "which takes seconds"


def test_states_and_margins_are_tables_in_notebooks():
    state = rg.GraspState(rg.Grasp([*GRASP.contacts[:2], GRASP.contacts[2]]), LOAD, STATE.forces)
    html = state._repr_html_()
    cells = re.findall(r"<td>(.*?)</td>", html)
    assert cells[:3] == ["P1", "3.7897", "3.0034"]
    assert len(cells) == 3 * 6
    assert len(re.findall("<tr>", state.margins._repr_html_())) == 4
    assert rg.plan_removal(STATE, "P3").margins([0.0, 1.0])._repr_html_() is None
    named = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5, name="<b>"), rg.Contact([1, 0], [-1, 0], 0.5)])
    assert "<td>&lt;b&gt;</td>" in rg.choose_state(named, rg.Wrench([0, -1.0]))._repr_html_()
