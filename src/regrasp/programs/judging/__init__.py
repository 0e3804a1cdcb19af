"""Whether an answer is sound: residuals by rows, certificates, convexity, and what is nearly right mended."""
