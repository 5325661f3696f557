"""Riccati, Stein and Lyapunov equations, each solution with a certificate."""
