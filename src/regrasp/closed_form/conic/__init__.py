"""Small conic programs on plain arrays, for millions of grasps."""
