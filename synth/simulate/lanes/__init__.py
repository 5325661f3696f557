"""Vectorised simulation: several machines side by side, one in each lane of a vector unit."""
