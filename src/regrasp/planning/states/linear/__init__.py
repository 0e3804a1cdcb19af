"""Linear limits of contacts in proofs that no forces exist."""
