"""Proofs about a program over its declared ranges: intervals, safe operations, induction over a step."""
