"""What tests of the screen share."""

from __future__ import annotations

from collections.abc import Iterator
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


@pytest.fixture
def keeping(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Pressed]:
    """Return a screen with a hand that keeps history in memory."""
    pytest.importorskip("starlette")
    from tests.aff_hmi.pressed import Pressed, quick

    quick(monkeypatch)
    found = Pressed(tmp_path, keeps=True)
    yield found
    assert found.kept is not None
    found.kept.close()
