"""The loop of the planar stage closed by the estimate: calibration, controller, experiments."""
