"""What forces within a region do at most along a twist: upper bounds in rationals, and in doubles."""
