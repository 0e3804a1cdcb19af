"""Distances and paths, whoever goes there."""
