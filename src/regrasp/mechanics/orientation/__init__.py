"""Directions and turns in space: tangents, quaternions, even spirals of directions."""
