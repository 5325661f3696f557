"""Verification of the emitted C: independent witnesses, stimuli, costs and proofs."""
