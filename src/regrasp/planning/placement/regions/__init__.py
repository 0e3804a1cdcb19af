"""Regions around the fingers of a grasp: wherever in them these are, they hold the loads."""
