"""What differs between the plane and space in a regrasp: shapes, orientations and holds."""
