"""What chosen grasps claim besides their proof: levels, and contacts that the proof is about."""
