"""Meshes from files: as they are written, mended where they can be, and what that did in words."""
