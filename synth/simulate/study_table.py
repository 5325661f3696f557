"""The table of a study as CSV, as Parquet and as a document for JSON."""

import csv
import io
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from synth.base import store
from synth.errors import DesignError
from synth.simulate.study import CONFIDENCE, StudyTable, estimate_yield, summarise


def columns(table: StudyTable) -> dict[str, NDArray[Any]]:
    """Return the columns by name: row, deviations z in tolerances, checks and figures."""
    return {"row": table.rows, **{f"z {n}": z for n, z in table.z.items()}, **table.checks, **table.figures}


def csv_text(table: StudyTable) -> str:
    """Return the table as comma-separated values."""
    lines = io.StringIO()
    writer = csv.writer(lines, lineterminator="\n")
    writer.writerow(columns(table))
    writer.writerows(zip(*(values.tolist() for values in columns(table).values()), strict=True))
    return lines.getvalue()


def require_parquet() -> tuple[Any, Any]:
    """Return pyarrow and its module of Parquet; raise DesignError where they are not installed."""
    try:
        return import_module("pyarrow"), import_module("pyarrow.parquet")
    except ImportError as error:
        raise DesignError(
            "a table as Parquet needs pyarrow, which is not installed: run `pip install 'synth-stage[parquet]'`, "
            "or give --csv"
        ) from error


def write_parquet(table: StudyTable, path: Path) -> None:
    """Write the table as Parquet, in one step; raise DesignError without pyarrow."""
    arrow, parquet = require_parquet()
    buffer = io.BytesIO()
    parquet.write_table(arrow.table({name: np.asarray(v) for name, v in columns(table).items()}), buffer)
    store.replace_bytes(path, buffer.getvalue())


def document(table: StudyTable) -> dict[str, Any]:
    """Return the summary for JSON."""
    share = estimate_yield(table)
    return {
        "rows": len(table.rows),
        "yield": {"share": share.share, "low": share.low, "high": share.high, "confidence": CONFIDENCE},
        "integration": vars(table.integration),
        "summaries": [vars(summary) for summary in summarise(table)],
        "errors": [list(error) for error in table.errors],
    }
