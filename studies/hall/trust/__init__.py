"""Ensemble simulations of the compiled C: convergence from starts, endurance in motion, sensor failures."""
