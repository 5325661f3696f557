"""State feedback: LQR, pole placement, and weights for them."""
