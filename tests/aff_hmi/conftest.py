"""What tests of the screen's hand share."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from tests.aff_hmi.pressed import Pressed


@pytest.fixture
def at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Pressed:
    """Return a screen with a hand, its service a double and its clock turned by hand."""
    from tests.aff_hmi.pressed import Pressed, quick  # needs the extra of the screen

    quick(monkeypatch)
    return Pressed(tmp_path)
