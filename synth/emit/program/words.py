"""Words of names: what several names, split at their underscores, have in common."""

from collections.abc import Sequence
from itertools import takewhile

LONGEST = 24  # letters of a name for several values


def common(names: Sequence[str]) -> str:
    """Return the words that names have in common in the same places, joined by underscores, "" for no identifier.

    ``regulator_x_sum`` and ``regulator_z_sum`` have ``regulator_sum`` in common. ``row_1`` and ``gradient_1`` have no
    more than a number in common, with which no identifier begins.
    """
    words = [name.split("_") for name in names]
    if len({len(w) for w in words}) > 1:
        first = _leading(words)
        shared = [*first, *_leading([w[len(first) :][::-1] for w in words])[::-1]]
    else:
        shared = [column[0] for column in zip(*words, strict=True) if len(set(column)) == 1]
    joined = "_".join(shared)
    return joined if joined.isidentifier() else ""


def combine(names: Sequence[str]) -> str:
    """Return one name for a value with several: ``sign_y1_y3`` for ``sign_y1`` and ``sign_y3``, else the last."""
    shared, ends = common(names), [name.rpartition("_")[2] for name in names]
    alike = len(names) > 1 and all(name == f"{shared}_{end}" for name, end in zip(names, ends, strict=True))
    together = "_".join([shared, *ends])
    return together if alike and len(together) <= LONGEST else names[-1]


def _leading(words: Sequence[Sequence[str]]) -> list[str]:
    return [column[0] for column in takewhile(lambda column: len(set(column)) == 1, zip(*words, strict=False))]
