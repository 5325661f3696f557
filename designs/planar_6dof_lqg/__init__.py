"""The planar positioner under a reduced-order LQG regulator at 800 Hz, Yu and Kim (26)-(49)."""
