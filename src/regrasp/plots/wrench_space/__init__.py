"""Wrench planes, cones, loops, and the equilibrium locus."""
