"""Files of pictures, which appear whole or not at all."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from regrasp.errors import InvalidInput


@contextmanager
def written(target: Path) -> Iterator[Path]:
    """Where to write first, a name of the same ending; moved to the target at the end.

    What is there and is no file, a pipe or a device, is written to directly.
    Raises ``InvalidInput`` where it cannot be written.
    """
    target = Path(os.path.realpath(target))  # a link stays a link
    if target.is_dir():
        raise InvalidInput(f"{target}: expected a file to write, found a folder")
    try:
        if target.exists() and not target.is_file():
            yield target
            return
        with TemporaryDirectory(prefix=".regrasp-", dir=target.parent) as temporary:
            part = Path(temporary, "part").with_suffix(target.suffix)
            yield part
            part.replace(target)
    except OSError as error:
        raise InvalidInput(f"{target}: cannot be written: {error.strerror or error}") from None
