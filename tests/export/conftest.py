"""One built project for the tests that run it; each test gets a folder of its own with links to its programs."""

from pathlib import Path

import pytest

from tests.export import harness


@pytest.fixture(scope="session")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = harness.export("levitator_2dof", tmp_path_factory.mktemp("export") / "levitator_2dof")
    harness.build(folder)
    return folder


@pytest.fixture
def loop(built: Path, tmp_path: Path) -> Path:
    """A folder to run the loop in."""
    for name in ("levitator_2dof", "client", "channels.toml", "vectors"):
        (tmp_path / name).symlink_to(built / name)
    return tmp_path
