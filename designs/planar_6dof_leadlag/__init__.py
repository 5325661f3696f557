"""The planar positioner under lead-lag compensators at 1 kHz, Yu and Kim (21)-(25)."""
