"""Studies: a function of many cases, a row for each, on processes or a cluster, restarted where it ended."""
