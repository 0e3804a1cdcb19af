"""A browser for pages: Debian's chromium, driven by Playwright. Without it tests skip; in CI they fail."""

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

import pytest


def lacking() -> str | None:
    """What is missing to run a browser, or None."""
    if find_spec("playwright") is None:
        return "playwright is not installed: pip install playwright"
    if shutil.which("chromium") is None:
        return "no chromium on the path: apt-get install chromium"
    return None


@contextmanager
def browser() -> Iterator[Any]:
    """A chromium without a window."""
    missing = lacking()
    if missing is not None:
        if os.environ.get("CI") == "true":
            pytest.fail(missing)
        pytest.skip(missing)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        try:
            yield chromium
        finally:
            chromium.close()


def until(page: Any, expression: str, tries: int = 500) -> None:
    """Wait until an expression holds; the pages' policy forbids Playwright's own way, which is eval."""
    for _ in range(tries):
        if page.evaluate(expression):
            return
        page.wait_for_timeout(20)
    pytest.fail(f"never true: {expression}")


def page_of(chromium: Any, address: str, width: int = 1100, height: int = 800, **options: Any) -> Any:
    """A page at an address; its ``problems`` are what its scripts and its console complained of."""
    page = chromium.new_page(viewport={"width": width, "height": height}, **options)
    page.problems = []
    page.on("pageerror", lambda error: page.problems.append(str(error)))
    page.on("console", lambda said: page.problems.append(said.text) if said.type == "error" else None)
    page.goto(address)
    return page
