"""Convex programs and the solvers that answer them. Knows nothing of contacts."""

from regrasp.programs.assembly import Rows
from regrasp.programs.backends import available_backends, solve
from regrasp.programs.blocks import Block, Cone
from regrasp.programs.pattern import Pattern
from regrasp.programs.program import Program
from regrasp.programs.solution import Solution, Status

__all__ = ["Block", "Cone", "Pattern", "Program", "Rows", "Solution", "Status", "available_backends", "solve"]
