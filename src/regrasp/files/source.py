"""The text of a file, and errors that name the file they are about."""

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path

from regrasp.errors import Infeasible, InvalidInput, RegraspError
from regrasp.mechanics.value import one_line


def text_of(path: Path, expected: str) -> str:
    """The text of a UTF-8 file. Raises ``InvalidInput`` where there is none to read."""
    if path.is_dir():
        raise InvalidInput(f"{path}: expected {expected}, found a folder")
    try:
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise InvalidInput(f"{path}: expected {expected}, found no such file") from None
    except UnicodeDecodeError as error:
        raise InvalidInput(
            f"{path}: expected {expected}, found no UTF-8 text (at byte {error.start})"
        ) from None
    except OSError as error:
        raise InvalidInput(f"{path}: cannot be read: {error.strerror}") from None


@contextmanager
def naming(file: str | Path) -> Iterator[None]:
    """Put the file's name before the message of every ``InvalidInput`` and ``Infeasible`` raised inside."""
    try:
        yield
    except InvalidInput as error:
        raise InvalidInput(f"{file}: {error}") from None
    except Infeasible as error:
        raise Infeasible(f"{file}: {error}", error.certificate) from None


@contextmanager
def legible(names: Iterable[str]) -> Iterator[Callable[[object], str]]:
    """A function that shows values with line breaks in ``names`` escaped; errors inside are shown so, too.

    A name from a file must not forge a line of what is printed.
    """
    odd = sorted({name for name in names if not name.isprintable()}, key=len, reverse=True)

    def shown(value: object) -> str:
        text = str(value)
        for name in odd:
            text = text.replace(name, one_line(name))
        return text

    try:
        yield shown
    except RegraspError as error:
        error.args = (shown(error), *error.args[1:])
        raise
