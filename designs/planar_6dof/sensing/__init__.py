"""Position and yaw from three two-axis Hall sensors: calibration, sections of a pitch, and contradictions."""
