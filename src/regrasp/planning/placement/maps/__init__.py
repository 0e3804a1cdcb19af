"""The value of placements over the boundary of an outline."""
