"""Parameter combinations that data do not determine, as text: the null space of a regressor.

v is a direction in which theta can change without a change of Phi theta. Near nominal values the changes are stated
relative to them, v_i / theta_i: "a and b in proportion" where they are equal, "a and 1/b" where they are opposite.
"""

from collections.abc import Sequence

import numpy as np

from synth.statespace import Array

RANK = 1e-10  # of the largest singular value, columns of length 1: below it a direction is not determined
ABSENT = 1e-6  # of the largest component of a direction: a smaller one is zero
EQUAL = 1e-3  # relative: tolerance of changes that are stated as proportional


def undetermined_combinations(
    sigma: Array, V: Array, size: Array, parameters: Sequence[str], near: Array | None = None
) -> list[str]:
    """Return the combinations of parameters that a regressor U diag(sigma) V' diag(size) does not determine.

    sigma and `size` are (k,), V is (k, k); `near` (k,) are nominal values.
    """
    null = V[:, sigma <= RANK * max(1.0, sigma.max(initial=0.0))].T
    texts = []
    for v in _row_echelon(null):
        involved = np.flatnonzero(v)
        names = [parameters[int(i)] for i in involved]
        if near is not None and near[involved].all():
            texts.append(_relative_text(v[involved] / size[involved] / near[involved], names))
        else:
            texts.append(_absolute_text(v[involved] / size[involved], names))
    return texts


def _row_echelon(basis: Array) -> Array:
    """Return vectors (r, k) that span the same space, each with few components: the row echelon form."""
    vectors = basis.copy()
    for row in range(len(vectors)):
        i, j = divmod(int(np.abs(vectors[row:]).argmax()), vectors.shape[1])
        vectors[[row, row + i]] = vectors[[row + i, row]]
        vectors[row] /= vectors[row, j]
        for other in range(len(vectors)):
            if other != row:
                vectors[other] -= vectors[other, j] * vectors[row]
    return np.where(np.abs(vectors) > ABSENT, vectors, 0.0)


def _relative_text(change: Array, names: Sequence[str]) -> str:
    change = change / change[np.abs(change).argmax()]
    if len(names) == 1:
        return names[0]
    if (np.abs(np.abs(change) - 1) < EQUAL).all():
        terms = [name if c * change[0] > 0 else f"1/{name}" for c, name in zip(change, names, strict=True)]
        return f"{', '.join(terms[:-1])} and {terms[-1]} in proportion"
    terms = [f"{name} by {100 * c:+.3g} %" for c, name in zip(change, names, strict=True)]
    return f"a change of {', '.join(terms[:-1])} and {terms[-1]}"


def _absolute_text(v: Array, names: Sequence[str]) -> str:
    if len(names) == 1:
        return names[0]
    terms = zip(v / np.linalg.norm(v) * np.sign(v[0]), names, strict=True)
    return " ".join(f"{'-' if c < 0 else '+'} {abs(c):.2g} {name}" for c, name in terms).removeprefix("+ ")
