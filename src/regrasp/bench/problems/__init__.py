"""What a solver is asked, with which settings, and what it answers."""
