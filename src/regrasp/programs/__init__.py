"""Convex programs and the solvers that answer them. Knows nothing of contacts."""

from typing import TYPE_CHECKING

from regrasp.later import later

if TYPE_CHECKING:
    from regrasp.programs.assembly import Rows
    from regrasp.programs.backends import solve
    from regrasp.programs.blocks import Block, Cone
    from regrasp.programs.facts import available_backends
    from regrasp.programs.pattern import Pattern
    from regrasp.programs.program import Program
    from regrasp.programs.solution import Solution, Status

__all__ = ["Block", "Cone", "Pattern", "Program", "Rows", "Solution", "Status", "available_backends", "solve"]

# SciPy's sparse matrices take longer than all of two contacts.
_WHERE = {
    "Block": "blocks",
    "Cone": "blocks",
    "Pattern": "pattern",
    "Program": "program",
    "Rows": "assembly",
    "Solution": "solution",
    "Status": "solution",
    "available_backends": "facts",
    "solve": "backends",
}

__getattr__, __dir__ = later(__name__, _WHERE)
