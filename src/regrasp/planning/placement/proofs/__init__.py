"""Proofs that no placement is better than a bound: boxes that cover all of them, each with a twist."""
