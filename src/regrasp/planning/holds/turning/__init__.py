"""Holds over all orientations of a planar object: arcs in closed form, and sequences among them."""
