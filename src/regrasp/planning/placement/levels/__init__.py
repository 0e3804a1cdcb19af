"""Objectives that are a level at which limited forces must exist, and the search for the best level."""
