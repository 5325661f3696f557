"""Feedback linearisation."""
