"""A plan as a page: one file, small, from nowhere else, with the plan's own numbers, whatever names say."""

import json
import re
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from browser import browser, page_of, until
from paper import GRASP, LOAD, STATE
from regrasp import plots
from regrasp.motions import plan_motions

pytestmark = pytest.mark.contract

ELLIPSE = rg.Outline.ellipse(2, 1)


def places(name: str, *shares: float) -> rg.Grasp:
    return rg.Grasp(
        ELLIPSE.contact_at(s * ELLIPSE.length, friction=0.5, name=f"{name}{i}") for i, s in enumerate(shares)
    )


@pytest.fixture(scope="module")
def removal() -> rg.Transition:
    return rg.plan_removal(STATE, "P3")


@pytest.fixture(scope="module")
def regrasp() -> rg.RegraspPlan:
    start, goal = places("A", 0.02, 0.35, 0.7), places("B", 0.2, 0.5, 0.85)
    load, options = rg.Wrench([0, -3.0]), {"friction": 0.5, "orientations": 12, "candidates": 40}
    return rg.plan_regrasp(ELLIPSE, start, goal, load, goal_orientation=1.5, **options)


def test_an_object_of_the_other_kind_is_no_input(removal: rg.Transition) -> None:
    square = rg.Outline([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    solid = ([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
    feet = rg.Grasp(rg.Contact([x, y, 0], [0, 0, 1], 0.5) for x, y in ((1, 0), (-1, 1), (-1, -1)))
    for value, given, words in (
        (removal, {"mesh": solid}, "mesh is of an object in space, which this is not; give outline"),
        (
            rg.choose_state(feet, rg.Wrench([0, 0, -1]), "effort"),
            {"outline": square},
            "outline is of an object in the plane, which this is not; give mesh",
        ),
    ):
        with pytest.raises(rg.InvalidInput, match=words):
            plots.html(value, **given)


def shown(page: str) -> Any:
    found = re.search(r'<script type="application/json" id="shown">(.*?)</script>', page, re.DOTALL)
    assert found is not None
    return json.loads(found[1])


def test_forces_are_the_plans(removal: rg.Transition) -> None:
    page = shown(plots.html(removal))
    for t, _, moving, angle, load, fingers in page["frames"]:
        np.testing.assert_allclose([f["force"] for f in fingers], removal.forces(t), rtol=1e-4, atol=1e-4)
        assert (moving, angle, load) == (False, 0, [-1.5, -3.5])
    np.testing.assert_allclose(
        page["lines"][0]["margins"], np.degrees(removal.margins(page["times"]).angle[:, 0]), rtol=1e-4
    )
    assert page["lines"][2]["margins"][-1] is None
    assert [line["name"] for line in page["lines"]] == page["fingers"] == ["P1", "P2", "P3"]


def test_of_a_regrasp_every_step_and_move_is_there(regrasp: rg.RegraspPlan) -> None:
    page = shown(plots.html(regrasp, outline=ELLIPSE))
    assert [step["words"] for step in page["steps"]] == [step.in_words for step in regrasp.steps]
    assert {frame[1] for frame in page["frames"]} == set(range(len(regrasp.steps)))
    moves = {
        (frame[1], f["number"]) for frame in page["frames"] if frame[2] for f in frame[5] if not f["normal"]
    }
    assert moves >= {(move.step, move.finger) for move in regrasp.moves}
    assert page["known"]
    assert page["frames"][-1][3] == pytest.approx(1.5, abs=1e-5)


def test_motions_are_shown_as_they_are_planned(regrasp: rg.RegraspPlan) -> None:
    ways = plan_motions(regrasp, ELLIPSE, tip_radius=0.05, clearance=0.01)
    page = shown(plots.html(ways, outline=ELLIPSE))
    flying = [f["at"] for frame in page["frames"] for f in frame[5] if f["normal"] is None]
    assert flying
    assert "suggested" not in page["key"]
    assert "suggested" in shown(plots.html(regrasp, outline=ELLIPSE))["key"]


def test_limits_are_there() -> None:
    limited = rg.Grasp([*GRASP.contacts[:2], rg.Contact([0, 8], [0, -1], 0.3, max_force=9.0, name="P3")])
    page = shown(plots.html(rg.plan_removal(limited, "P3", load=LOAD)))
    assert [line["limit"] for line in page["lines"]] == [None, None, 9.0]


@pytest.mark.parametrize("which", ["state", "removal", "regrasp"])
def test_a_page_is_one_small_file_that_asks_for_nothing(
    which: str, removal: rg.Transition, regrasp: rg.RegraspPlan
) -> None:
    page = plots.html({"state": STATE, "removal": removal, "regrasp": regrasp}[which])
    assert len(page.encode()) < 1_000_000
    assert "default-src 'none'" in page
    assert re.findall(r"(?:src|href)=|@import|url\(|https?://(?!www\.w3\.org/2000/svg)", page) == []


@pytest.mark.parametrize("name", ["</script><b>", "$x_1$", "<!--<script>", '"&amp;', "a\\u2028b"])
def test_names_are_text(name: str) -> None:
    grasp = rg.Grasp([rg.Contact([-1, 0], [1, 0], 0.5, name=name), rg.Contact([1, 0], [-1, 0], 0.5)])
    state = rg.choose_state(grasp, rg.Wrench([0, -1.0]))
    page = plots.html(state, title=name)
    assert shown(page)["frames"][0][5][0]["name"] == name
    assert page.count("</script>") == 2


def test_an_outline_belongs_to_the_plane(removal: rg.Transition) -> None:
    with pytest.raises(rg.InvalidInput, match="outline must be an Outline, or in space a mesh"):
        plots.html(removal, outline=3.0)  # type: ignore[call-overload]


@pytest.mark.parametrize("width", [700, 400])
def test_a_page_plays(width: int, regrasp: rg.RegraspPlan, tmp_path: Any) -> None:
    path = plots.html(regrasp, tmp_path / "plan.html", outline=ELLIPSE, title="$\\frac{1}{2}$ <b>")
    with browser() as chromium:
        page = page_of(chromium, path.as_uri(), width=width)
        until(page, "document.getElementById('plan').dataset.regrasp == 'drawn'")
        assert page.evaluate("document.documentElement.scrollWidth") == width
        assert page.locator("h1").inner_text() == "$\\frac{1}{2}$ <b>"
        before = page.locator(".stage").inner_html()
        page.locator("#play").click()
        until(page, "document.getElementById('time').value > 5")
        assert page.locator(".stage").inner_html() != before
        page.locator("#time").evaluate("s => { s.value = s.max; s.dispatchEvent(new Event('input')) }")
        assert page.locator(".steps li.now").inner_text() == regrasp.steps[-1].in_words
        assert page.problems == []
