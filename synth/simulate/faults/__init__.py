"""Fault campaigns: faults injected into the simulated machine, and what they do to it."""
