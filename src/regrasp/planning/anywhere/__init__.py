"""Regrasps of fingers anywhere on an outline: the map of holds in polygons, walks on it, proofs of none."""
