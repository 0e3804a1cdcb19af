"""Pictures of grasps chosen from a shape."""
