"""Held directions, sensitivities, comparisons of solvers."""
