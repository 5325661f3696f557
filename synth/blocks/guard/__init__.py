"""The input guard, bad samples and missed calls, the latch, and the safe output."""
