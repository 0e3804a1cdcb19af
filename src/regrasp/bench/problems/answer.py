"""What a solver answers to one program, taken from whatever it returned."""

from math import inf
from typing import Any

import numpy as np

from regrasp.errors import InvalidInput, shown
from regrasp.programs.answer import Answer, Claim
from regrasp.programs.blocks import Array
from regrasp.programs.program import Program


def understood(given: Any, program: Program) -> Answer:
    """An ``Answer`` of anything with its attributes; only ``status`` and ``x`` must be there.

    Raises ``InvalidInput`` for a word that is none of ``Claim`` and for arrays of another shape.
    """
    words = [claim.value for claim in Claim]
    status = getattr(given, "status", None)
    if status not in words:
        raise InvalidInput(f"a solver's answer needs a status among {', '.join(words)}, got {shown(status)}")
    status = Claim(status).value  # a plain word: the runner must not import what another kind of string is
    x = _array("x", getattr(given, "x", None), program.q.size)
    if x is None and status == Claim.FOUND.value:
        raise InvalidInput("a solver's answer that is found needs x")
    times = (_number(given, name) for name in ("build_time", "setup_time", "solve_time"))
    duals = _array("duals", getattr(given, "duals", None), program.b.size)
    said = printable(getattr(given, "said", "") or status)
    count = _number(given, "iterations")
    return Answer(status, x, duals, None if count is None else int(count), said, *times)


def printable(words: Any) -> str:
    """What somebody said, as text that can be written; nothing that is said ends a run."""
    try:
        text = str(words)
    except Exception:
        text = f"an unprintable {type(words).__name__}"
    return text.encode("utf-8", "replace").decode("utf-8")


def _array(name: str, values: Any, size: int) -> Array | None:
    """A finite array of the size wanted; a solver that fills with NaN has given nothing."""
    if values is None:
        return None
    array = np.array(values, dtype=float).ravel()
    if array.size != size:
        raise InvalidInput(f"{name} of a solver's answer must have {size} entries, got {array.size}")
    return array if np.isfinite(array).all() else None


def _number(given: Any, name: str) -> float | None:
    """A time or a count; one that makes no sense has not been told."""
    value = getattr(given, name, None)
    return None if value is None or not 0 <= float(value) < inf else float(value)
