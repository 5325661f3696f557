"""Combinations of parameters that data do not determine, as text: the null space of a regressor.

v spans a direction in which theta may go without any change of Phi theta. Near known values the changes are told
relative to them, v_i / theta_i: "a and b in proportion" where they are equal, "a and 1/b" where they are opposite.
"""

from collections.abc import Sequence

import numpy as np

from synth.statespace import Array

RANK = 1e-10  # of the largest singular value, columns of length 1: what is below counts as not determined
ABSENT = 1e-6  # of the largest component of a direction: below it a parameter does not take part
EQUAL = 1e-3  # relative: by how much changes may differ that are told as proportional


def combinations(
    sigma: Array, V: Array, size: Array, parameters: Sequence[str], near: Array | None = None
) -> list[str]:
    """Return the combinations of parameters that a regressor U diag(sigma) V' diag(size) does not determine.

    sigma and `size` are (k,), V is (k, k); `near` (k,) are known values.
    """
    null = V[:, sigma <= RANK * max(1.0, sigma.max(initial=0.0))].T
    found = []
    for v in _sparse(null):
        part = np.flatnonzero(v)
        names = [parameters[int(i)] for i in part]
        if near is not None and near[part].all():
            found.append(_relative(v[part] / size[part] / near[part], names))
        else:
            found.append(_absolute(v[part] / size[part], names))
    return found


def _sparse(basis: Array) -> Array:
    """Return vectors (r, k) that span the same space, each with few components: the row echelon form."""
    found = basis.copy()
    for row in range(len(found)):
        i, j = divmod(int(np.abs(found[row:]).argmax()), found.shape[1])
        found[[row, row + i]] = found[[row + i, row]]
        found[row] /= found[row, j]
        for other in range(len(found)):
            if other != row:
                found[other] -= found[other, j] * found[row]
    return np.where(np.abs(found) > ABSENT, found, 0.0)


def _relative(change: Array, names: Sequence[str]) -> str:
    change = change / change[np.abs(change).argmax()]
    if len(names) == 1:
        return names[0]
    if (np.abs(np.abs(change) - 1) < EQUAL).all():
        terms = [name if c * change[0] > 0 else f"1/{name}" for c, name in zip(change, names, strict=True)]
        return f"{', '.join(terms[:-1])} and {terms[-1]} in proportion"
    terms = [f"{name} by {100 * c:+.3g} %" for c, name in zip(change, names, strict=True)]
    return f"a change of {', '.join(terms[:-1])} and {terms[-1]}"


def _absolute(v: Array, names: Sequence[str]) -> str:
    if len(names) == 1:
        return names[0]
    terms = zip(v / np.linalg.norm(v) * np.sign(v[0]), names, strict=True)
    return " ".join(f"{'-' if c < 0 else '+'} {abs(c):.2g} {name}" for c, name in terms).removeprefix("+ ")
