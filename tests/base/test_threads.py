"""Commands and tests run linear algebra in one thread; a program that has imported NumPy keeps its own number."""

import os
import subprocess
import sys

import pytest

VARIABLE = "OPENBLAS_NUM_THREADS"


@pytest.mark.parametrize(
    ("before", "setting", "after"),
    [("", None, "1"), ("import numpy", None, "None"), ("", "2", "2")],
    ids=["first", "after NumPy", "by the environment"],
)
def test_one_thread_before_numpy_is_imported_and_where_nothing_else_is_said(
    before: str, setting: str | None, after: str
) -> None:
    environment = {name: value for name, value in os.environ.items() if name != VARIABLE}
    program = (
        f"{before}\nimport os\nfrom synth.base import threads\nthreads.use_one()\nprint(os.environ.get('{VARIABLE}'))"
    )
    command = [sys.executable, "-c", program]
    outcome = subprocess.run(
        command, env=environment | ({VARIABLE: setting} if setting else {}), capture_output=True, text=True, check=True
    )
    assert outcome.stdout.strip() == after


def test_these_tests_run_in_one_thread() -> None:
    assert os.environ[VARIABLE], "the plugin of pyproject.toml is loaded before NumPy"
