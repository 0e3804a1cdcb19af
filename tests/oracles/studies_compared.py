"""Studies compared: rows without what may differ between runs."""

from pathlib import Path
from typing import Any

import regrasp as rg

OF_THE_RUN = ["seconds", "machine", "versions"]


def rows(folder: Path) -> Any:
    """The rows of a study in the order of their keys, without times and machines."""
    frame = rg.read_study(folder)
    assert frame["key"].is_unique
    return frame.drop(columns=OF_THE_RUN).sort_values("key", ignore_index=True)


def raw_keys(folder: Path) -> list[str]:
    """The keys of all parts, doubled ones twice: without the reader that is tested."""
    from pyarrow import parquet

    return [key for part in folder.glob("*.parquet") for key in parquet.read_table(part)["key"].to_pylist()]
