"""A grasp, a state, an outline."""
