"""Layouts of sensors."""
