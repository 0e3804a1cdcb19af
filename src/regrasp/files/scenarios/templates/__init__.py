"""Scenarios with comments, one for each kind of task, to start from."""

from importlib.resources import files
from pathlib import Path

from regrasp.errors import InvalidInput

NAMES = (
    *(
        f"{where}{kind}"
        for where in ("", "space-")
        for kind in ("removal", "addition", "rotation", "regrasp", "grasp")
    ),
)


def template(name: str) -> str:
    """The text of a scenario, one of ``NAMES``."""
    return (files(__name__) / f"{name}.toml").read_text(encoding="utf-8")


def write_new(path: Path, text: str) -> None:
    """Write a text to a file that is not there yet. Raises ``InvalidInput`` where one is, or none can be."""
    try:
        with path.open("x", encoding="utf-8") as file:
            file.write(text)
    except FileExistsError:
        raise InvalidInput(f"{path}: there is such a file already; give another name") from None
    except OSError as error:
        raise InvalidInput(f"{path}: cannot be written: {error.strerror or error}") from None
