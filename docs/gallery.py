"""Draws the pictures of gallery.md from the code beside them: python docs/gallery.py.

Each example of the page that makes a `figure` is followed by the picture of it.
"""

import re
from pathlib import Path

PAGE = Path(__file__).with_name("gallery.md")
EXAMPLE = re.compile(r"^```python\n(.*?)^```\n+(?:!\[[^\]]*\]\((.+?)\))?", re.MULTILINE | re.DOTALL)


def draw(page: Path = PAGE) -> None:
    """Run the examples in order, in one namespace, and save each figure where the page shows it."""
    names: dict[str, object] = {}
    for code, picture in EXAMPLE.findall(page.read_text(encoding="utf-8")):
        exec(compile(code, str(page), "exec"), names)
        if picture:
            target = page.parent / picture
            target.parent.mkdir(exist_ok=True)
            names["figure"].savefig(target, dpi=140, metadata={"Software": None})  # type: ignore[attr-defined]


if __name__ == "__main__":
    draw()
