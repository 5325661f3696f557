"""Fixtures of the audit of the planar positioner."""

from functools import cache

import pytest

from models import planar_stage

PLANT_AS_PUBLISHED = cache(planar_stage.plant)


@pytest.fixture
def plant_built_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Have rows that ask for the plant as published get one that is built once: its equations do not change here."""
    monkeypatch.setattr(planar_stage, "plant", PLANT_AS_PUBLISHED)
