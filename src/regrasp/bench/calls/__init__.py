"""Solvers that the benchmark calls through other packages, with their own defaults.

Those called by their own name are in ``regrasp.programs.calls``.
"""
