"""Control laws as Blocks: linear models, regulators, servo axes, lead-lag, lookup tables, maps of errors."""
