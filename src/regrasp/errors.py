"""The errors regrasp raises. Each message says what was expected, what came, and what to do."""

from typing import Any


class RegraspError(Exception):
    """Base class of every error regrasp raises on purpose."""


class InvalidInput(RegraspError, ValueError):
    """An argument, a scenario or a plan file is not what it must be; nothing was computed."""


class Infeasible(RegraspError):
    """No forces inside the friction cones and force limits balance the load.

    ``certificate`` is the ``EscapeTwist`` that proves it, a ``RegraspObstacle`` of a whole regrasp, or None
    where only the message can say why.
    """

    def __init__(self, message: str, certificate: Any = None) -> None:
        super().__init__(message)
        self.certificate = certificate


class SolverUnavailable(RegraspError):
    """The back end asked for is unknown or not installed."""


class SolverFailed(RegraspError):
    """A solver's answer did not pass our own audit. Carries the ``program`` and the ``solution``."""

    def __init__(self, message: str, program: Any = None, solution: Any = None) -> None:
        super().__init__(message)
        self.program = program
        self.solution = solution
