"""Regenerate the numbers and the C of this design: `python -m designs.hall_position`, in the workspace's root."""

from pathlib import Path

from designs.hall_position.design import DESIGN
from synth import workspace

workspace.regenerate(DESIGN, Path())
