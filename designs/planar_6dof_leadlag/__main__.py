"""Regenerate the gains and the C of this design: `python -m designs.planar_6dof_leadlag`, in the workspace's root."""

from pathlib import Path

from designs.planar_6dof_leadlag.design import DESIGN
from synth.emit import write

for folder, files in DESIGN.emit(DESIGN.scalar).items():
    write.save(files.files, Path("generated_c") / folder)
