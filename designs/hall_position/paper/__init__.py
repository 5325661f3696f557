"""The audit of Kawato and Kim's paper K: what it prints, recomputed."""
