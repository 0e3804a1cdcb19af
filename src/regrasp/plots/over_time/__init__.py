"""Forces, margins, loads and the time function over time."""
