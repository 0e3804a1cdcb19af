"""States of many grasps at once."""
