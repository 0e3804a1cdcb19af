"""Files of cuts: why no regrasp exists, to be judged by ``verify``."""

import json
from pathlib import Path
from typing import Any

from regrasp.errors import InvalidInput, shown
from regrasp.files.source import text_of
from regrasp.files.staging import whole_file
from regrasp.mechanics.checks import file_path
from regrasp.plans.regrasp_cut import RegraspCut

FORMAT = "regrasp cut"


def write_cut(cut: RegraspCut, path: str | Path) -> None:
    """Write a cut with everything needed to read it back and verify it.

    Args:
        cut: the ``cut`` of a ``RegraspObstacle``.
        path: the file, in JSON.

    Raises:
        InvalidInput: For what is no cut, and where the file cannot be written.
    """
    if not isinstance(cut, RegraspCut):
        raise InvalidInput(f"write_cut writes a RegraspCut, got {shown(cut)}")
    with whole_file(file_path(path)) as file:
        json.dump({"format": FORMAT, "version": 1} | cut.to_dict(), file, indent=1, allow_nan=False)
        file.write("\n")


def read_cut(path: str | Path) -> RegraspCut:
    """The cut of a file that ``write_cut`` wrote; judge it with ``regrasp.verify``.

    Args:
        path: a file that ``write_cut`` wrote.

    Raises:
        InvalidInput: For a file that holds no cut.
    """
    path = file_path(path)
    data = _data(path)
    if not isinstance(data, dict) or data.get("format") != FORMAT or data.get("version") != 1:
        raise InvalidInput(f"{path}: not a cut of format {FORMAT!r}, version 1")
    try:
        return RegraspCut.from_dict({k: v for k, v in data.items() if k not in ("format", "version")})
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from None


def holds_a_cut(path: Path) -> bool:
    """Whether a file says that it is a cut."""
    try:
        data = _data(path)
    except InvalidInput:
        return False
    return isinstance(data, dict) and data.get("format") == FORMAT


def _data(path: Path) -> Any:
    try:
        return json.loads(text_of(path, "a cut in JSON"))
    except (ValueError, RecursionError) as error:
        raise InvalidInput(f"{path}: not JSON, or cut short: {error}") from None
