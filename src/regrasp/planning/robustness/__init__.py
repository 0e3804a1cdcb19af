"""How far friction, loads, contacts and stiffness may be off before a state or a plan fails."""
