"""Choosing states and planning transitions between them."""
