"""Proofs that are about the faces of a mesh: boxes of patches, and which part of it they cover."""
