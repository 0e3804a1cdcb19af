"""Outlines from DXF, as they are seen."""
