"""Servo regulators: internal models, their gains and anti-windup."""
