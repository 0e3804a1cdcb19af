"""Formulas compiled for millions of grasps. The only users of Numba beside the audit."""
