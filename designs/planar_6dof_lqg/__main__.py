"""Regenerate what is committed of this design: `python -m designs.planar_6dof_lqg`, in the workspace's root."""

from designs.planar_6dof_lqg.design import DESIGN
from synth.workspace import regenerate

regenerate(DESIGN)
