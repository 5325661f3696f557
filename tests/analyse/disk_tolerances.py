"""Tolerances of disk margins: rounding, and the first level of their certificate."""

from tests import tolerances

DOUBLE = tolerances.of("double")
LEVEL = 3e-6  # the first level of the certificate is 1e-6 above the peak, and the peak is accurate to the same
