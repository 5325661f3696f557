"""Passes over a lowered program: folding, polynomials, limits that never act, the order of statements."""
