"""What several tests of this folder start from."""

from pathlib import Path

import pytest

from tests.aff_runtime.config.shipped import copied


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with copies of every shipped site file and wire file."""
    return copied(tmp_path)
