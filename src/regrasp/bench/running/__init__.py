"""Running solvers over problems: processes, settings, rows that outlive everything."""
