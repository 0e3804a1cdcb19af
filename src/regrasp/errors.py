"""The errors regrasp raises. Each message says what was expected, what came, and what to do."""

import re
from collections.abc import Callable
from typing import Any

# A value in a message is a reminder, not a listing; a message is one to read: what is long is in the middle.
_SHOWN = 120
_HEAD, _TAIL = 330, 160


def told(error: BaseException) -> str:
    """An error of others: its kind and, where it can be read, its message."""
    try:
        return f"{type(error).__name__}: {error}"
    except Exception:
        return type(error).__name__


def shown(value: Any) -> str:
    """A value as a message shows it: on one line, not long, whatever it is."""
    try:
        text = repr(value)
    except Exception:  # a number of too many digits to print, or a class whose own repr fails
        text = f"a value of type {type(value).__name__}"
    text = re.sub(r"\s+", " ", text)
    return text if len(text) <= _SHOWN else f"{text[: _SHOWN - 3]}..."


def readable(message: str) -> str:
    """A message on one line; of a long one, as of a grasp of a thousand names, both ends."""
    line = re.sub(r"\s*\n\s*", " ", str(message))
    return line if len(line) <= _HEAD + _TAIL + 5 else f"{line[:_HEAD]} ... {line[-_TAIL:]}"


class RegraspError(Exception):
    """Base class of every error regrasp raises on purpose."""


class InvalidInput(RegraspError, ValueError):
    """An argument, a scenario or a plan file is not what it must be; nothing was computed.

    The message is one line, whatever values it names.

    Args:
        message: one line: what was expected, what came, what to do.
    """

    def __init__(self, message: str) -> None:
        super().__init__(readable(message))


class InvalidFile(InvalidInput):
    """A file with any number of problems, a line each."""

    def __init__(self, message: str) -> None:
        super(InvalidInput, self).__init__("\n".join(map(readable, message.splitlines())))


class Infeasible(RegraspError):
    """No forces inside the friction cones and force limits balance the load.

    ``certificate`` is the ``EscapeTwist`` that proves it, a ``RegraspObstacle`` of a whole regrasp, or None
    where only the message can say why. What would help is worked out when the message is first read.

    Args:
        message: one line: what was expected, what came, what to do.
        certificate: what proves it, or None.
    """

    def __init__(self, message: str, certificate: Any = None) -> None:
        super().__init__(readable(message))
        self.certificate = certificate
        self._helps: Callable[[], str] | None = None

    def helped(self, helps: Callable[[], str]) -> None:
        """Say what would help behind the message, in words that are asked for when it is first read.

        Args:
            helps: returns the words, or none.
        """
        self._helps = helps

    @property
    def reason(self) -> str:
        """The message as far as it is known at once, without what would help."""
        return str(self.args[0])

    def __str__(self) -> str:
        if self._helps is not None:
            helps, self._helps = self._helps, None
            if words := helps():
                self.args = (readable(f"{self.args[0]}; {words}"),)
        return str(self.args[0])

    def __reduce__(self) -> tuple[Any, ...]:
        return Infeasible, (str(self), self.certificate)


class SolverUnavailable(RegraspError):
    """The back end asked for is unknown or not installed."""


class SolverFailed(RegraspError):
    """A solver's answer did not pass our own audit. Carries the ``program`` and the ``solution``.

    Args:
        message: one line: what was expected, what came, what to do.
        program: what was to be solved.
        solution: the answer that did not pass.
    """

    def __init__(self, message: str, program: Any = None, solution: Any = None) -> None:
        super().__init__(readable(message))
        self.program = program
        self.solution = solution
