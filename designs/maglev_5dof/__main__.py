"""Regenerate what is committed of this design: `python -m designs.maglev_5dof`, in the workspace's root."""

from designs.maglev_5dof.design import DESIGN
from synth.workspace import regenerate

regenerate(DESIGN)
