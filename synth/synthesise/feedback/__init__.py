"""State feedback: LQR, pole placement, deadbeat control, and weights for them."""
