"""Sets of loads."""
