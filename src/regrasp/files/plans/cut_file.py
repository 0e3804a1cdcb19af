"""Files of cuts: why no regrasp exists, to be judged by ``verify``."""

from pathlib import Path
from typing import cast

from regrasp.files.plans.claims import holds_claim, read_claim, write_claim
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
    write_claim(cut, path, FORMATS, "write_cut")


def read_cut(path: str | Path) -> RegraspCut | OutlineCut:
    """The cut of a file that ``write_cut`` wrote; judge it with ``regrasp.verify``.

    Args:
        path: a file that ``write_cut`` wrote.

    Raises:
        InvalidInput: For a file that holds no cut.
    """
    return cast(RegraspCut | OutlineCut, read_claim(path, FORMATS, "a cut"))


def holds_a_cut(path: Path) -> bool:
    """Whether a file says that it is a cut."""
    return holds_claim(path, FORMATS)
