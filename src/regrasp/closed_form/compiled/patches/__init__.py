"""Fingers on patches of a surface: a gauge of what they hold, a search over boxes of places, and a climb."""
