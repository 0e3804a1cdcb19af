"""How far friction, loads and the centre of mass may go: extremes proven from both sides."""
