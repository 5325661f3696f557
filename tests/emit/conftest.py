"""The emitter is tested without its cache: a planted defect reaches the C, and its C does not enter the cache."""

import pytest

from synth.emit import pipeline


@pytest.fixture(autouse=True)
def emission_without_cache(monkeypatch: pytest.MonkeyPatch) -> None:
    """Emit without the cache of a Block's C."""
    monkeypatch.setattr(pipeline, "c_source", pipeline.c_source.__wrapped__)  # type: ignore[attr-defined]
