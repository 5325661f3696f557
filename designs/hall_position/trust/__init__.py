"""Ensembles of bodies through the compiled C: starts, motions, failing sensors."""
