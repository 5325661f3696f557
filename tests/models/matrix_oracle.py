"""A matrix of six pitches of two grades of blocks in magpylib, written out block by block from the paper's Fig. 2."""

import magpylib
import numpy as np

l = 50.8e-3  # m
# One pitch from block (0, 0) on, X to the right and Y down the page: up, down, blank, and the way the weak blocks lean
# or lie. `n`, `s` are strong; a weak block's letters are its parts along X, Y and Z.
PITCH = (
    ("n", "-x+z", ".", "+x+z"),
    ("-y+z", "-x-y", "-y-z", "+x-y"),
    (".", "-x-z", "s", "+x-z"),
    ("+y+z", "-x+y", "+y-z", "+x+y"),
)


def remanence(name: str, strong: float, weak: float) -> np.ndarray:
    """Return the remanence (3,) in T of a block by its name."""
    if name in ".ns":
        return np.array([0.0, 0.0, {".": 0.0, "n": strong, "s": -strong}[name]])
    parts = np.array([name.count(f"+{axis}") - name.count(f"-{axis}") for axis in "xyz"])
    return weak * parts / np.linalg.norm(parts)


def blocks(strong: float = 1.43, weak: float = 1.10, pitches: int = 6) -> magpylib.Collection:
    """Return the matrix, its faces at z = 0, the origin in a strong block that is the first one past the middle."""
    collection, side, n = magpylib.Collection(), l / 4, 2 * pitches
    for i in range(-n, n):
        for j in range(-n, n):
            J = remanence(PITCH[j % 4][i % 4], strong, weak)
            if J.any():
                at = (i * side, j * side, -side / 2)
                collection.add(magpylib.magnet.Cuboid(polarization=J, dimension=(side,) * 3, position=at))
    return collection
