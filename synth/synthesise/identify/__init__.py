"""Identification of parameters from logged data: linear and nonlinear least squares, trajectories."""
