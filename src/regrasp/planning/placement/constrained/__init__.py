"""Constraints that bounds know nothing of, and where to begin with them."""
