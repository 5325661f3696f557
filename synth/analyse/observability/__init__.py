"""Observability of unknowns q in y = h(q) + e: Fisher information, its worst place, lost rank, sensor placement."""
