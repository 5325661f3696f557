"""What the voltages tell of a pose: deviations, lost rank, layouts of sensors."""
