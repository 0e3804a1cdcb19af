"""Checks of ways through the air, which share no code with what planned them."""
