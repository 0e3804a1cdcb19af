"""Runs the python blocks of a Markdown file and returns what they print beside what it says they print."""

import io
import re
from contextlib import redirect_stdout
from itertools import pairwise
from pathlib import Path

_BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def examples(path: Path) -> list[tuple[str, str]]:
    """(code, promised output) for each python block."""
    blocks = [*_BLOCK.findall(path.read_text(encoding="utf-8")), ("", "")]
    return [
        (code, following[1] if following[0] == "text" else "")
        for (language, code), following in pairwise(blocks)
        if language == "python"
    ]


def executed(path: Path) -> list[tuple[str, str, str]]:
    """(code, promised output, actual output) for each python block; blocks share one namespace."""
    namespace: dict[str, object] = {}
    result = []
    for code, promised in examples(path):
        printed = io.StringIO()
        with redirect_stdout(printed):
            exec(compile(code, str(path), "exec"), namespace)
        result.append((code, promised, printed.getvalue()))
    return result


def rewrite(page: Path | str) -> None:
    """Put what the blocks print today into the text blocks that follow them."""
    path = Path(page)
    text = path.read_text(encoding="utf-8")
    for code, promised, actual in executed(path):
        before = f"```python\n{code}```\n\n```text\n"
        text = text.replace(f"{before}{promised}```", f"{before}{actual}```")
    path.write_text(text, encoding="utf-8")
