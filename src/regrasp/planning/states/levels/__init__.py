"""The highest level of narrowed cones, climbed by Newton's method."""
