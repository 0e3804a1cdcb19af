"""The hold graph and the sequences of holds on it."""
