"""How far disk margins may be off: by rounding, and by the first level of their certificate."""

from tests import tolerances

DOUBLE = tolerances.of("double")
LEVEL = 3e-6  # the first level of the certificate is 1e-6 above the peak, and the peak is found to as much
