"""Static analysis of a program over its declared ranges: interval arithmetic, safety proofs, inductive state bounds."""
