"""Simulation of the closed loop: the full plant, its sensors, and the compiled C as the controller."""
