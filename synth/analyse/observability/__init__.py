"""Observability of unknowns q in y = h(q) + e: Fisher information, worst case over q, rank loss."""
