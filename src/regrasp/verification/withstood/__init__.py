"""Whether every member of a set of deviations is withstood, decided in rational arithmetic."""
