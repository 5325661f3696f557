"""Audit of Kawato and Kim's paper K: its printed figures, recomputed."""
