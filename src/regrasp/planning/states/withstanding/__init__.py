"""Forces that withstand a set of load deviations: what is demanded of them, as rows of programs."""
