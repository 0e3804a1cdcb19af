"""Two contacts at any orientation: the loads that they hold, and the margin with which they do."""
