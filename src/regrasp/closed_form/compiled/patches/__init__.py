"""Fingers on patches of a surface: a gauge of what they hold, the search over boxes of places, and a climb."""
