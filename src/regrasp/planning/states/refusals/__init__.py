"""What would help where a verb refuses: the least friction or force, or the most that may be asked."""
