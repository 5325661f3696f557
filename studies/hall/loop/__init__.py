"""Position loop of the planar stage closed with the estimate: calibration, controller, experiments."""
