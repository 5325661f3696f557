"""The modified GLSDC estimator, of (X, Y, yaw) and of six degrees of freedom, as Blocks."""
