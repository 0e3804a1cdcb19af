"""Plans as values: transitions, time functions, loads over time, whole regrasps. Nothing here plans."""
