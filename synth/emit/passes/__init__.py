"""Passes over a lowered program: constant folding, surrogates, elimination of idle limits, scheduling."""
