"""``tmp_path`` of this suite: a folder for each test, made without a look at all others.

Pytest's own numbers a folder by the names of all that are there: 4 ms where 1500 tests of a worker
have had theirs, and 5 ms where 3000 have.
"""

from __future__ import annotations

import itertools
import re
from pathlib import Path

import pytest

_NUMBERS = itertools.count()
LONGEST_NAME = 25
"""Of a test, in the name of its folder, which is then no longer than pytest's: the path of a
socket in it has 107 characters at most."""


@pytest.fixture
def tmp_path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An empty folder of this test alone, kept as long as pytest keeps its own."""
    name = re.sub(r"\W", "_", request.node.name)[:LONGEST_NAME]
    folder = tmp_path_factory.getbasetemp() / "t" / f"{name}{next(_NUMBERS)}"
    folder.parent.mkdir(mode=0o700, exist_ok=True)
    folder.mkdir(mode=0o700)
    return folder
