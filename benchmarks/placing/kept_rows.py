"""Rows of a benchmark in a JSON file, written one by one, so that a run goes on where it was ended."""

import json
from pathlib import Path
from typing import Any

Rows = dict[str, Any]


def rows_in(path: Path) -> Rows:
    """Those that are there."""
    found: Rows = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
    return found


def keep(path: Path, kept: Rows, key: str, row: Rows) -> None:
    """Add one and show it; an interrupt leaves the file as it was or whole."""
    kept[key] = row
    print(key, row, flush=True)
    part = path.with_suffix(".part")
    part.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")
    part.replace(path)


def short(row: Rows) -> Rows:
    """The row with numbers of seven digits."""
    return {k: float(f"{v:.7g}") if isinstance(v, float) else v for k, v in row.items()}
