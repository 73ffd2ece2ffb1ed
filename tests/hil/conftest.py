from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.hil.live_line import LiveLine
from tests.lockstep.fault_table import LIMITS_M_S


@pytest.fixture(scope="module")  # not of the session: beside every other test it takes half a core
def _processes(tmp_path_factory: pytest.TempPathFactory) -> Iterator[LiveLine]:
    line = LiveLine(_short(tmp_path_factory))
    try:
        yield line
    finally:
        line.close()


@pytest.fixture
def line(_processes: LiveLine) -> Iterator[LiveLine]:
    """Plant and service, correcting; what never may happen is judged after each scenario."""
    _processes.at_plant("clear")
    try:
        _processes.ensure_active()
    except AssertionError:  # an earlier scenario, or a try of it, left the service dead
        _processes.start_again()
        _processes.ensure_active()
    _processes.at_plant("reset")
    yield _processes
    status = _processes.at_plant("status")
    largest = status["max_abs_applied_m_s"].values()
    for value, limit in zip(largest, LIMITS_M_S, strict=True):
        assert 0.0 <= value <= limit + 1e-12
    assert status["counts"]["foreign_writes"] == 0
    assert status["counts"]["foreign_reads"] == 0


def _short(factory: pytest.TempPathFactory) -> Path:
    """Return a folder whose sockets have names short enough for the system."""
    folder = factory.mktemp("hil")
    assert len(str(folder / "run" / "control.sock")) < 100
    return folder
