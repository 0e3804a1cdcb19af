"""Splines in NumPy: importing those of SciPy takes longer than most plans."""
