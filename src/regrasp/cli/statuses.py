"""Exit statuses: which end of a run has which number."""

from typing import Any

from regrasp.errors import Infeasible, InvalidInput, RegraspError, SolverUnavailable

VERIFIED, UNVERIFIED, BAD_INPUT, INFEASIBLE = 0, 1, 2, 3
"""0 only for a plan that verified, and for commands that judge none and did their work."""
HUNG_UP, INTERRUPTED, PIPE_CLOSED, TERMINATED = 129, 130, 141, 143
"""128 and the number of the signal, as shells count."""

WORDS = {
    UNVERIFIED: "not verified",
    BAD_INPUT: "bad input",
    INFEASIBLE: "infeasible",
    HUNG_UP: "ended",
    INTERRUPTED: "interrupted",
    TERMINATED: "ended",
}


class Unverified(RegraspError):
    """A plan broke a condition. Carries all ``violations``."""

    def __init__(self, message: str, violations: tuple[str, ...]) -> None:
        super().__init__(message)
        self.violations = violations


def status_of(error: RegraspError) -> int:
    """The exit status of an error."""
    if isinstance(error, Infeasible):
        return INFEASIBLE
    return BAD_INPUT if isinstance(error, (InvalidInput, SolverUnavailable)) else UNVERIFIED


def facts_of(error: BaseException, status: int, message: str) -> dict[str, Any]:
    """What JSON says of a run that ended with an error."""
    facts: dict[str, Any] = {"status": WORDS[status], "exit": status, "message": message}
    if isinstance(error, Unverified):
        facts["violations"] = error.violations
    if isinstance(error, Infeasible):
        facts["certificate"] = _certificate(error.certificate)
    return facts


def _certificate(certificate: Any) -> dict[str, Any] | None:
    if certificate is None:
        return None
    facts: dict[str, Any] = {"kind": type(certificate).__name__}
    for name in ("twist", "is_proof", "explanation", "friction", "max_force", "margin", "without"):
        if hasattr(certificate, name):
            facts[name] = getattr(certificate, name)
    return facts
