"""The least of a cost of forces, from forces that are nearly the best."""
