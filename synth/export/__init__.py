"""Runnable projects around the emitted step."""
