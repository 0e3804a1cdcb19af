"""Where fingers go on surfaces in space."""
