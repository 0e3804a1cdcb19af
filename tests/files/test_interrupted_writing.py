"""An interrupt at any moment of writing leaves no temporary folder, and a file whole or not at all."""

import gc
import sys
from collections.abc import Callable
from itertools import count
from pathlib import Path
from types import FrameType

import pytest

from regrasp.disk import staging
from regrasp.errors import InvalidInput

pytestmark = pytest.mark.contract


class Stopped(BaseException):
    """As a signal's handler raises it: when a function begins, or when one in C has returned."""


def stopped_at(number: int, write: Callable[[], None]) -> bool:
    """Whether ``write`` came to that moment, and was stopped there."""
    moments = count()

    def profile(frame: FrameType, event: str, _: object) -> None:
        if event in ("call", "c_return") and next(moments) == number:
            sys.setprofile(None)
            raise Stopped

    sys.setprofile(profile)
    try:
        write()
    except (Stopped, InvalidInput):  # the latter of a descriptor that rmtree, stopped, closes twice
        return True
    finally:
        sys.setprofile(None)
    return False


def write_file(folder: Path) -> None:
    with staging.whole_file(folder / "plan.txt") as file:
        file.write("new")


def write_folder(folder: Path) -> None:
    with staging.whole_folder(folder) as new:
        (new / "plan.txt").write_text("new")


@pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("write", [write_file, write_folder])
def test_an_interrupt_at_any_moment_leaves_no_temporary_folder(
    write: Callable[[Path], None], tmp_path: Path
) -> None:
    gc.freeze()  # each look for garbage is a short one
    for moment in count(step=3):
        (tmp_path / "plan.txt").write_text("old")
        stopped = stopped_at(moment, lambda: write(tmp_path))
        gc.collect()  # as at the end of the process
        assert [path.name for path in tmp_path.iterdir()] == ["plan.txt"], moment
        assert (tmp_path / "plan.txt").read_text() in ("old", "new"), moment
        if not stopped:
            break
    gc.unfreeze()
    assert moment > 100
    assert (tmp_path / "plan.txt").read_text() == "new"
