"""Regenerate what is committed of this design: `python -m designs.maglev_5dof_precise`, in the workspace's root."""

from designs.maglev_5dof_precise.design import DESIGN
from synth.workspace import regenerate

regenerate(DESIGN)
