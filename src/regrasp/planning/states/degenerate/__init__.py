"""What general programs answer badly: no load, minima that are flat."""
