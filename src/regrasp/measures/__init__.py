"""How good a grasp is: closure, and the measures of the literature; see docs/quality.md."""
