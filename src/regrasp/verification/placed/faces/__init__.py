"""Proofs about fingers on flat faces in space."""
