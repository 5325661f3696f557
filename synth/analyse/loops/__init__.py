"""Loops opened at a signal, their responses and crossings, stability margins, disk margins, structured robustness."""
