"""A control process that does not begin to tick: ended, and told as that."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from tests.aff_runtime.app.supervisor.whole import Whole


def died(caplog: pytest.LogCaptureFixture) -> list[str]:
    return [one.getMessage() for one in caplog.records if "CONTROL_DIED" in one.getMessage()]


@pytest.mark.parametrize(
    ("waits_s", "told"), [(14.9, "killed by SIGKILL"), (15.1, "no tick within 15 s")]
)
def test_who_ended_a_control_process_that_never_ticked_is_told(
    waits_s: float,
    told: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    caplog: pytest.LogCaptureFixture,
) -> None:
    caplog.set_level(logging.WARNING)
    whole = Whole(tmp_path, monkeypatch)
    whole.children.ring = None
    whole.control.how_it_ended = "killed by SIGKILL" if waits_s < 15.0 else None
    whole.wait(waits_s)
    assert told in died(caplog)[0]
    assert len(died(caplog)) == 1
    whole.stop()
