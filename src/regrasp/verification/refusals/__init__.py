"""Verdicts on refusals: proofs that what was asked for does not exist."""
