"""Jobs side by side: what fails stops what comes after it and nothing else, and the run ends."""

import os
from collections.abc import Callable
from typing import Any

import pytest

from synth.base.jobs import Job, run
from synth.base.progress import Lines, Progress
from synth.errors import DesignError


def gives(value: Any) -> Callable[[Progress], Any]:
    def job(say: Progress) -> Any:
        say(f"makes {value}")
        return value

    return job


def refuses(say: Progress) -> None:
    raise DesignError("the stage has no plant")


def crashes(say: Progress) -> None:
    raise ZeroDivisionError("a defect")


def dies(say: Progress) -> None:
    os._exit(3)


@pytest.mark.parametrize("processes", [1, 2])
@pytest.mark.parametrize(
    ("job", "error", "is_crash"),
    [
        (refuses, "the stage has no plant", False),
        (crashes, "ZeroDivisionError: a defect", True),
        (dies, "its process ended with status 3", True),
    ],
)
def test_what_comes_after_a_failed_job_is_not_run_and_the_run_ends(
    job: Callable[[Progress], Any], error: str, is_crash: bool, processes: int
) -> None:
    """The failed job is the last that runs: nothing is left to wait for."""
    jobs = [Job("emit", "a", job), Job("verify", "a", gives(1), ("emit",)), Job("report", "a", gives(2), ("verify",))]
    outcomes = run(jobs, Lines(lambda about, line: None), processes)
    assert error in outcomes["emit"].error and outcomes["emit"].is_crash is is_crash
    assert outcomes["verify"].error == "not run: emit failed"
    assert outcomes["report"].error in ("not run: emit failed", "not run: verify failed")


def test_other_jobs_finish_and_tell_their_progress() -> None:
    lines: list[tuple[str, str]] = []
    jobs = [Job("a", "first", refuses), Job("b", "second", gives(2)), Job("c", "second", gives(3), ("b",))]
    outcomes = run(jobs, Lines(lambda about, line: lines.append((about, line))), 1)
    assert [(o.value, o.error) for o in outcomes.values()] == [(None, "the stage has no plant"), (2, ""), (3, "")]
    assert list(outcomes) == ["a", "b", "c"] and lines == [("second", "makes 2"), ("second", "makes 3")]
