"""Files of one claim each, whose class is told by the format that they state."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol

from regrasp.disk.staging import whole_file
from regrasp.errors import InvalidInput, shown
from regrasp.files.plans.json_text import data_of
from regrasp.mechanics.checks import file_path


class Claim(Protocol):
    """What has plain data."""

    def to_dict(self) -> dict[str, Any]:
        """The claim as plain data."""

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> Any:
        """The claim of plain data."""


Formats = Mapping[str, type[Claim]]


def write_claim(claim: Any, path: str | Path, formats: Formats, writer: str) -> None:
    """Write a claim of one of some classes. ``InvalidInput`` for others, and where it cannot be written.

    writer: the name of the public function, for that message.
    """
    form = next((form for form, kind in formats.items() if isinstance(claim, kind)), None)
    if form is None:
        known = " or a ".join(kind.__name__ for kind in formats.values())
        raise InvalidInput(f"{writer} writes a {known}, got {shown(claim)}")
    with whole_file(file_path(path)) as file:
        json.dump({"format": form, "version": 1} | claim.to_dict(), file, indent=1, allow_nan=False)
        file.write("\n")


def read_claim(path: str | Path, formats: Formats, what: str) -> Any:
    """The claim of a file, of one of some formats. ``InvalidInput`` for any other file.

    what: what it should be, as "a cut".
    """
    path = file_path(path)
    data = data_of(path, what)
    kind = formats.get(_form(data))
    if kind is None or data.get("version") != 1 or type(data["version"]) is not int:  # True == 1
        known = " or ".join(map(repr, formats))
        raise InvalidInput(f"{path}: not {what} of format {known}, version 1")
    try:
        return kind.from_dict({k: v for k, v in data.items() if k not in ("format", "version")})
    except InvalidInput as error:
        raise InvalidInput(f"{path}: {error}") from None


def holds_claim(path: Path, formats: Formats) -> bool:
    """Whether a file says that it is of one of some formats."""
    try:
        return _form(data_of(path, "JSON")) in formats
    except InvalidInput:
        return False


def _form(data: Any) -> str:
    """The format that a file states; empty for none."""
    form = data.get("format") if isinstance(data, dict) else None
    return form if isinstance(form, str) else ""
