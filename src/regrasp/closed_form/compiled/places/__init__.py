"""Fingers on arcs of a boundary: what their forces do, a gauge of what they hold, and a search for places."""
