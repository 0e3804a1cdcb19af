"""Whole regrasps: their steps, the moments of a plan in the world, hold maps."""
