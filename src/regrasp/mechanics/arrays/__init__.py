"""Arrays of grasps, checked and laid out for work on many at once."""
