"""Planning one change of a grasp: a finger leaves or arrives, or the object turns."""
