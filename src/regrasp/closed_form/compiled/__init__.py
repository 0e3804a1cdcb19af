"""Formulas compiled by Numba for millions of grasps, and loops shared out to threads."""
