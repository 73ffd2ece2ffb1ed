import pytest

from aff_runtime.app.hand import accounts
from tests.aff_runtime.app.commission.made_line import Line
from tests.doubles.virtual_clock import VirtualClock


@pytest.fixture
def clock():
    return VirtualClock(1)


@pytest.fixture
def line(tmp_path, monkeypatch, clock):
    """A line that carl and cleo may commission; a password costs no time."""
    monkeypatch.setattr(accounts, "_N", 2)
    (tmp_path / "rt").mkdir(mode=0o700)
    found = Line(tmp_path, clock)
    yield found
    found.commissioner.close()
