"""Scenarios: what a person writes in a TOML file, and the way to its plan."""
