"""Calibration of three or four sensors over a matrix as built, the estimator that uses it, and its survey."""
