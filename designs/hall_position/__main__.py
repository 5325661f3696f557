"""Regenerate the numbers and the C of this design: `python -m designs.hall_position`, in the workspace's root."""

from pathlib import Path

import numpy as np

from designs.hall_position import emitted
from synth.emit import write

for folder, files in emitted.emitted(np.float32).items():
    write.save(files.files, Path("generated_c") / folder)
