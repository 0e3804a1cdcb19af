"""Planning whole regrasps, of planar objects and of solid ones."""
