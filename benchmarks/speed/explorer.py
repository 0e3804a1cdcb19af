"""From a finger dragged in the explorer to the picture of its new forces: median and 95 % [ms].

    python benchmarks/speed/explorer.py

Needs playwright and chromium. Both ends are measured in the page:
from the movement of the pointer to the frame after the picture was drawn, exact verification between them.
"""

import shutil
import statistics
import threading
from math import cos, sin
from typing import Any

from playwright.sync_api import sync_playwright

from regrasp.explore.server import Server
from regrasp.explore.start import start_of

GOAL = 30.0
MOVES = 150
DRAWN = "document.getElementById('explorer').regrasp.drawn"


def measured(chromium: Any, part: str | None, width: int) -> list[float]:
    """Milliseconds of every picture while the third finger is dragged to and fro."""
    with Server(start_of(part)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        page = chromium.new_page(viewport={"width": width, "height": 800})
        page.goto(server.address)
        page.wait_for_selector(".handle")
        box = page.locator("[data-handle='2'] .ring").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x, y)
        page.mouse.down()
        for k in range(MOVES):
            if k == 10:
                page.evaluate(f"{DRAWN}.length = 0")  # what compiles and caches does so at first
            page.mouse.move(x + 40 * sin(k / 15), y + 10 * (1 - cos(k / 10)))
            page.wait_for_timeout(25)
        page.wait_for_timeout(300)
        found: list[float] = page.evaluate(DRAWN)
        page.close()
        server.shutdown()
        return found


def main() -> None:
    """A table on the paper's example, an outline and a mesh, wide and narrow."""
    print("| beginning | width [px] | pictures | median [ms] | 95 % [ms] | goal [ms] |")
    print("|---|---|---|---|---|---|")
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        for part in (None, "cam", "solid-bracket"):
            for width in (1100, 400):
                times = sorted(measured(chromium, part, width))
                tail = times[int(0.95 * len(times))]
                print(
                    f"| {part or 'paper'} | {width} | {len(times)} | {statistics.median(times):.1f} | "
                    f"{tail:.1f} | {GOAL:.0f} |"
                )
        chromium.close()


if __name__ == "__main__":
    main()
