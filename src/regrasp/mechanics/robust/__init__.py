"""What fixed forces withstand when fingers answer with their stiffness."""
