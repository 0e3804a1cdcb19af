"""The explorer in a browser: fingers dragged by mouse, touch and keys change what is seen, at any width."""

import threading
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import regrasp as rg
from browser import browser, page_of, until
from regrasp.explore.server import Server
from regrasp.explore.start import start_of

pytestmark = pytest.mark.end_to_end


@pytest.fixture(scope="module")
def chromium() -> Iterator[Any]:
    with browser() as found:
        yield found


@pytest.fixture
def served(request: pytest.FixtureRequest) -> Iterator[str]:
    with Server(start_of(getattr(request, "param", None))) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        yield server.address
        server.shutdown()
        thread.join()


def opened(chromium: Any, address: str, **options: Any) -> Any:
    page = page_of(chromium, address, **options)
    page.wait_for_selector(".handle")
    return page


def forces(page: Any) -> Any:
    return page.evaluate("document.getElementById('explorer').regrasp.answer().state.forces")


def picture(page: Any) -> str:
    return str(page.locator(".force").evaluate_all("all => all.map(a => a.outerHTML).join()"))


def settled(page: Any, act: Any) -> None:
    """Act, and wait until a new answer is drawn."""
    count = "document.getElementById('explorer').regrasp.drawn.length"
    before = page.evaluate(count)
    act()
    until(page, f"{count} > {before}")


def drag(page: Any, handle: int, right: float, down: float) -> None:
    box = page.locator(f"[data-handle='{handle}'] .ring").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + right, y + down, steps=3)
    page.mouse.up()


def test_a_finger_that_is_dragged_changes_the_forces(chromium: Any, served: str) -> None:
    page = opened(chromium, served)
    before, seen = forces(page), picture(page)
    assert len(before) == page.locator(".force").count() == 3
    settled(page, lambda: drag(page, 2, 25, 0))
    page.wait_for_timeout(200)
    assert forces(page) != before
    assert picture(page) != seen
    assert "proven at every instant" in page.locator(".verdict").inner_text()
    assert page.problems == []
    page.close()


@pytest.mark.parametrize("served", ["cam"], indirect=True)
def test_on_an_outline_fingers_stay_on_it_and_too_little_friction_shows_the_escape(
    chromium: Any, served: str
) -> None:
    page = opened(chromium, served)
    settled(page, lambda: drag(page, 2, 60, 40))
    page.wait_for_timeout(200)
    rings = start_of("cam").to_dict()["rings"]
    at = page.evaluate("document.getElementById('explorer').regrasp.answer().contacts[2].position")
    assert min((x - at[0]) ** 2 + (y - at[1]) ** 2 for x, y in rings[0]) < 1e-6
    assert page.locator(".ghost").count() == 0
    settled(page, lambda: page.locator("#friction").fill("0.01"))
    settled(page, lambda: page.locator("#leaves").select_option("P1"))
    page.wait_for_timeout(200)
    assert page.locator(".ghost").count() == 1
    assert "escapes" in page.locator(".verdict").inner_text()
    assert page.problems == []
    page.close()


def test_keys_move_turn_and_choose(chromium: Any, served: str) -> None:
    page = opened(chromium, served)
    before = forces(page)
    page.locator("[data-handle='0']").focus()
    settled(page, lambda: page.keyboard.press("ArrowUp"))
    moved = forces(page)
    assert moved != before
    assert page.evaluate("document.activeElement.dataset.handle") == "0", "the picture anew keeps the focus"
    settled(page, lambda: page.keyboard.press("q"))
    assert forces(page) != moved
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.dataset.handle") == "1"
    page.close()


def test_fingers_of_a_hand_on_a_small_screen(chromium: Any, served: str) -> None:
    page = opened(chromium, served, width=400, height=800, has_touch=True)
    assert page.evaluate("document.documentElement.scrollWidth") == 400
    before = forces(page)
    box = page.locator("[data-handle='2'] .ring").bounding_box()
    assert box["width"] >= 40
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    touch = page.context.new_cdp_session(page)

    def swipe() -> None:
        for kind, dx in (("touchStart", 0), ("touchMove", 8), ("touchMove", 16), ("touchEnd", None)):
            points = [] if dx is None else [{"x": x + dx, "y": y}]
            touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    settled(page, swipe)
    assert forces(page) != before
    assert page.problems == []
    page.close()


def test_playing_squeezing_copying_and_saving(chromium: Any, served: str) -> None:
    page = opened(chromium, served)
    page.locator("#play").click()
    until(page, "document.getElementById('time').value == 40")
    assert page.locator(".force").count() == 2, "the finger that left has no force"
    least = "document.getElementById('explorer').regrasp.answer().locus"
    low, high = page.evaluate(f"{least}.interval")
    settled(page, lambda: page.locator("#squeeze").fill(str(low + 0.9 * (high - low))))
    assert page.evaluate(f"{least}.chosen") == pytest.approx(low + 0.9 * (high - low), rel=1e-3)
    page.locator("#scenario").click()
    page.wait_for_selector("#copied")
    assert 'kind = "removal"' in page.locator("#copied").input_value()
    with page.expect_download() as saved:
        page.locator("#save").click()
    assert saved.value.suggested_filename == "regrasp.png"
    page.close()


@pytest.mark.parametrize("served", ["bracket"], indirect=True)
def test_looks_are_drawn_and_a_map_moves_two_fingers(chromium: Any, served: str) -> None:
    page = opened(chromium, served, width=400)
    page.locator("#look-loop").click()
    assert page.locator("[aria-label='Wrench loop'] .wrench").count() == 3
    for look, seen in (("tolerances", ".table td"), ("places", ".region.together"), ("map", ".marker")):
        page.locator(f"#look-{look}").click()
        page.wait_for_selector(seen, state="attached", timeout=60000)
    assert page.evaluate("document.documentElement.scrollWidth") == 400
    box = page.locator(".pixels").bounding_box()
    at = {"x": 0.25 * box["width"], "y": 0.8 * box["height"]}
    settled(page, lambda: page.locator(".pixels").click(position=at, force=True))
    asked = page.evaluate(
        "document.getElementById('explorer').regrasp.question.contacts.map(c => c.position)"
    )
    outline = start_of("bracket").shape
    assert isinstance(outline, rg.Outline)
    for share, position in zip((0.25, 0.2), asked, strict=False):
        s = outline.nearest(np.array(position) + outline.centre_of_mass)
        assert s / outline.length == pytest.approx(share, abs=0.02)
    page.locator("[aria-label='Map of two fingers']").focus()
    settled(page, lambda: page.keyboard.press("ArrowRight"))
    assert page.problems == []
    page.close()


@pytest.mark.parametrize("served", ["solid-bracket"], indirect=True)
def test_a_solid_is_turned_and_a_point_is_picked(chromium: Any, served: str) -> None:
    page = opened(chromium, served)
    contacts = "document.getElementById('explorer').regrasp.answer().contacts"
    box = page.locator(".stage").bounding_box()
    before, seen = page.evaluate(contacts), picture(page)
    page.mouse.move(box["x"] + 40, box["y"] + 40)
    page.mouse.down()
    page.mouse.move(box["x"] + 140, box["y"] + 60, steps=4)
    page.mouse.up()
    assert picture(page) != seen, "the view has turned"
    assert page.evaluate(contacts) == before, "and no finger has moved"
    page.locator(".stage").focus()
    for _ in range(6):
        page.keyboard.press("ArrowUp")  # looked at from above
    settled(page, lambda: page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"]))
    after = page.evaluate(contacts)
    assert after[0]["position"] != before[0]["position"], "the chosen finger is where the surface was tapped"
    assert after[1:] == before[1:]
    page.wait_for_timeout(100)
    settled(page, lambda: drag(page, 0, 8, 5))
    with page.expect_download() as saved:
        page.locator("#save").click()
    assert saved.value.suggested_filename == "regrasp.png"
    assert page.problems == []
    page.close()
