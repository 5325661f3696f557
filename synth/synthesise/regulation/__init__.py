"""Servo regulators: internal models, their gains, anti-windup and bumpless start."""
