"""A page of a transition in space is whole, loads nothing, and draws itself in a real browser."""

import json
import re
import shutil
import subprocess
import sys

import numpy as np
import pytest

import regrasp as rg
from pictured import box, lifted
from regrasp import plots

pytestmark = pytest.mark.contract


@pytest.fixture(scope="module")
def lift():
    return lifted()


@pytest.fixture(scope="module")
def block():
    return box(0.06, 0.04, 0.03)


CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--enable-unsafe-swiftshader",
    "--host-resolver-rules=MAP * ~NOTFOUND",  # no network at all
    "--virtual-time-budget=1000000",
)


# Plays to the end, then writes what the scene holds into an attribute.
PROBE = """<script>
const probe = () => {
  const page = document.querySelector('.plotly-graph-div');
  if (!document.documentElement.hasAttribute('data-regrasp')) {
    requestAnimationFrame(probe);
    return;
  }
  const last = page._transitionData._frames.length - 1;
  Plotly.animate(page, [String(last)], {mode: 'immediate', frame: {duration: 0, redraw: true}}).then(() => {
    const lines = page._fullData.filter(d => d.type === 'scatter3d' && d.mode === 'lines' && d.showlegend);
    const held = lines.map(d => [d.name, d.x.length && d.x[0] !== null && isFinite(d.x[0])]);
    const asked = performance.getEntriesByType('resource').map(entry => entry.name);
    document.documentElement.setAttribute('data-probe', JSON.stringify({held, asked}));
  });
};
probe();
</script>"""


@pytest.fixture(scope="module")
def page(lift, block):
    pytest.importorskip("plotly")
    return plots.html(lift, mesh=block)


def test_a_page_is_written_whole_or_not_at_all(lift, tmp_path):
    pytest.importorskip("plotly")
    target = tmp_path / "lift.html"
    assert plots.html(lift.start, target) == target
    assert target.read_text(encoding="utf-8").rstrip().endswith("</html>")
    assert [p.name for p in tmp_path.iterdir()] == ["lift.html"]
    with pytest.raises(rg.InvalidInput, match="cannot be written"):
        plots.html(lift.start, tmp_path / "nowhere" / "lift.html")


def test_a_page_shows_states_and_plans_only(lift):
    with pytest.raises(rg.InvalidInput, match="a Transition, a RegraspPlan or Motions; got Grasp"):
        plots.html(lift.grasp)


def test_without_plotly_one_line_names_the_extra(lift, monkeypatch):
    for module in ("plotly", "plotly.graph_objects"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ImportError, match=r"^pages need plotly: pip install 'regrasp\[html\]'$"):
        plots.html(lift.start)


def test_a_page_loads_nothing_from_elsewhere_and_sends_nothing(page):
    outside = re.findall(r"<(?:script|link|img|iframe)[^>]*(?:src|href)\s*=\s*[\"']?([^\"'> ]+)", page)
    assert [address for address in outside if address.startswith(("http", "//"))] == []
    assert '"showSendToCloud": false' in page or '"showSendToCloud":false' in page


def test_names_cannot_break_out_of_a_page():
    pytest.importorskip("plotly")
    page = plots.html(lifted(names=("</script><b>", "a", "b", "c")).start)
    assert "</script><b>" not in page


def shown_by_browser(page, folder, *flags):
    path = folder / "page.html"
    path.write_text(page, encoding="utf-8")
    command = [CHROMIUM, *FLAGS, f"--user-data-dir={folder / 'profile'}", *flags, path.as_uri()]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=True).stdout


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_a_browser_draws_the_page_plays_it_and_asks_for_nothing(page, lift, tmp_path):
    probed = page[: page.rindex("</body>")] + PROBE + "</body></html>"
    dom = shown_by_browser(probed, tmp_path, "--dump-dom")
    assert 'data-regrasp="drawn"' in dom
    body = re.sub(r"<script.*?</script>", "", dom, flags=re.DOTALL)
    assert "main-svg" in body
    assert "<canvas" in body
    assert "WebGL is not supported" not in body
    assert "angle margin [deg]" in body
    seen = json.loads(re.search(r'data-probe="([^"]*)"', dom)[1].replace("&quot;", '"'))
    assert dict(seen["held"]) == {
        name: name in (*lift.end.in_use, "load") for name in (*lift.grasp.names, "load")
    }
    assert [url for url in seen["asked"] if not url.startswith(("file:", "data:", "blob:"))] == []


@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here")
def test_a_browser_paints_the_scene_in_the_contacts_colours(lift, block, tmp_path):
    pytest.importorskip("plotly")
    from matplotlib.colors import to_rgb
    from matplotlib.image import imread

    picture = tmp_path / "page.png"
    shown_by_browser(
        plots.html(lift.start, mesh=block), tmp_path, f"--screenshot={picture}", "--window-size=900,700"
    )
    below = imread(picture)[80:, :, :3]  # without the legend
    for name, colour in plots.contact_colours(lift.grasp).items():
        near = np.abs(below - to_rgb(colour)).max(axis=-1) < 0.2
        assert near.sum() > 30, name
