"""Observers and the compensators on them: Kalman filters, LQG, reduced-order observers."""
