"""Regenerate the gains and the C of this design: `python -m designs.planar_6dof_lqg`, in the workspace's root."""

from pathlib import Path

import numpy as np

from designs.planar_6dof_lqg import emitted
from synth.emit import write

for folder, files in emitted.emitted(np.float32).items():
    write.save(files.files, Path("generated_c") / folder)
