"""Choosing the forces of a grasp under a load."""
