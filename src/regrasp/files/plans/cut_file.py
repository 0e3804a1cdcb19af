"""Files of cuts: why no regrasp exists, to be judged by ``verify``."""

import json
from pathlib import Path
from typing import Any

from regrasp.disk.staging import whole_file
from regrasp.errors import InvalidInput, shown
from regrasp.files.plans.json_text import data_of
from regrasp.mechanics.checks import file_path
from regrasp.plans.outline_cut import OutlineCut
from regrasp.plans.regrasp_cut import RegraspCut

FORMATS: dict[str, type[RegraspCut | OutlineCut]] = {
    "regrasp cut": RegraspCut,
    "regrasp outline cut": OutlineCut,
}


def write_cut(cut: RegraspCut | OutlineCut, path: str | Path) -> None:
    """Write a cut with everything needed to read it back and verify it.

    Args:
        cut: the ``cut`` of a ``RegraspObstacle``, or the ``certificate`` of ``OutlineRegrasps``.
        path: the file, in JSON.

    Raises:
        InvalidInput: For what is no cut, and where the file cannot be written.
    """
    form = next((form for form, kind in FORMATS.items() if isinstance(cut, kind)), None)
    if form is None:
        raise InvalidInput(f"write_cut writes a RegraspCut or an OutlineCut, got {shown(cut)}")
    with whole_file(file_path(path)) as file:
        json.dump({"format": form, "version": 1} | cut.to_dict(), file, indent=1, allow_nan=False)
        file.write("\n")


def read_cut(path: str | Path) -> RegraspCut | OutlineCut:
    """The cut of a file that ``write_cut`` wrote; judge it with ``regrasp.verify``.

    Args:
        path: a file that ``write_cut`` wrote.

    Raises:
        InvalidInput: For a file that holds no cut.
    """
    path = file_path(path)
    data = data_of(path, "a cut")
    kind = _kind(data)
    if kind is None or data.get("version") != 1:
        known = " or ".join(map(repr, FORMATS))
        raise InvalidInput(f"{path}: not a cut of format {known}, version 1")
    try:
        return kind.from_dict({k: v for k, v in data.items() if k not in ("format", "version")})
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from None


def holds_a_cut(path: Path) -> bool:
    """Whether a file says that it is a cut."""
    try:
        data = data_of(path, "a cut")
    except InvalidInput:
        return False
    return _kind(data) is not None


def _kind(data: Any) -> type[RegraspCut | OutlineCut] | None:
    """The class of a file's cut, by the format it states."""
    form = data.get("format") if isinstance(data, dict) else None
    return FORMATS.get(form) if isinstance(form, str) else None
