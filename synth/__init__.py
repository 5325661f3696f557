"""Symbolic modelling, controller synthesis and verified C for precision stages."""

__version__ = "0.1.0"
