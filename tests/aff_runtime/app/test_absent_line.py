"""A service whose serial line is not there says so, in its log and in ``status``.

Quick: the command, ``tests/aff_runtime/cli/test_main.py``; the wire, ``modbus/test_rtu_wire.py``.
"""

from __future__ import annotations

import contextlib
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.report.status_answer import read_answer
from aff_runtime.base.errors import AffError
from aff_runtime.cli.status import lines
from tests.aff_runtime.app.service_run import ROOT
from tests.aff_runtime.cli.test_main import serial_site
from tests.processes import until

pytestmark = pytest.mark.processes


@pytest.mark.long
@pytest.mark.wire
def test_a_serial_line_that_is_not_there_is_in_log_and_status(tmp_path: Path) -> None:
    site, log = serial_site(tmp_path, "/dev/ttyNONE"), tmp_path / "log"
    with log.open("w") as stream:
        service = subprocess.Popen(
            [
                *(sys.executable, "-m", "aff_runtime.cli.main", "run", str(site)),
                *("--runtime-dir", str(tmp_path / "rt"), "--record-dir", str(tmp_path / "runs")),
            ],
            stderr=stream,
            cwd=ROOT,
        )

    def status() -> dict[str, Any]:
        with contextlib.suppress(AffError):
            client = ServiceClient(tmp_path / "rt" / "control.sock", timeout_s=20.0)
            try:
                return client.ask("status")
            finally:
                client.close()
        return {}

    said = "the serial line /dev/ttyNONE does not open: "
    try:
        until("the wire", lambda: bool(status().get("wire")))
        answer = status()
        assert said in answer["wire"][0]
        shown = list(lines(read_answer(answer)))
        assert [line for line in shown if line.startswith("wire ") and said in line]
        assert f"wire: {said}" in log.read_text()
    finally:
        service.terminate()
        service.wait(20)
