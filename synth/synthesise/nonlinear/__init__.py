"""Feedback linearisation and dynamic extension."""
