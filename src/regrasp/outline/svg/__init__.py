"""Outlines from SVG, as they are seen."""
