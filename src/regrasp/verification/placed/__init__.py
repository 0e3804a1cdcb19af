"""Proofs about where fingers are: chosen grasps, bounds on placements, regions of contacts."""
