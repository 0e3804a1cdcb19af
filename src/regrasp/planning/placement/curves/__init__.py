"""Placement on smooth outlines: their sides, what tips reach, regions."""
