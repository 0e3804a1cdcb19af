"""What all pictures share: style, units, arrows, views. Imports no other room of pictures."""
