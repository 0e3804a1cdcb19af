"""The boundary of a planar object: where fingers can touch it, and where its weight acts."""

from regrasp.outline.outline import Outline

__all__ = ["Outline"]
