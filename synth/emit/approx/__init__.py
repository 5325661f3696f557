"""Approximation: functions of one variable become polynomials with a certificate."""
