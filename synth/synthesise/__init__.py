"""Synthesis of gains, observers, regulators and estimators; each result certifies itself."""
