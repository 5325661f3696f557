"""Regenerate what is committed of this design: `python -m designs.planar_6dof_leadlag`, in the workspace's root."""

from designs.planar_6dof_leadlag.design import DESIGN
from synth.workspace import regenerate

regenerate(DESIGN)
