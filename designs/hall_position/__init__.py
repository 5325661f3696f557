"""Absolute position and yaw from two-axis Hall sensors over a magnet matrix."""
