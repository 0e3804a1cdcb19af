"""Where to put fingers: grasps chosen from a shape, with proofs that none is better."""
