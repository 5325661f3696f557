"""Numbers for the analyses: extended precision, rounding, boxes, scaling, refinement of grids."""
