"""How an object escapes from a grasp that cannot hold it."""
