"""`make hmi`: plant, service and screen by one command, and nothing left when it ends."""

from __future__ import annotations

import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from sim_plant.demo.wires import free_port
from tests.aff_runtime.app.service_run import ROOT
from tests.processes import is_running, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(300)]


def children_of(pid: int) -> set[int]:
    """Return the processes that one has started, with theirs."""
    found: set[int] = set()
    for text in Path(f"/proc/{pid}/task/{pid}/children").read_text().split():
        found |= {int(text)} | children_of(int(text))
    return found


def test_one_command_prints_the_address_and_ends_all_it_started(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "sim_plant.cli.main", "live", "--hands-off"]
    command += ["--out", str(tmp_path / "out"), "--listen", f"127.0.0.1:{free_port()}"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, cwd=ROOT) as live:
        assert live.stdout is not None
        line = next(line for line in live.stdout if "look at the line: " in line)
        url = line.split()[-1]
        with urllib.request.urlopen(url) as page:
            assert page.status == 200

        def shows_the_line() -> bool:
            with urllib.request.urlopen(url) as page:
                return "<title>Euclid" in page.read().decode()

        until("the line on the page", shows_the_line)
        started = children_of(live.pid)
        assert len(started) >= 4  # plant, supervisor, control process, screen
        live.terminate()
        assert live.wait(60.0) == 0
    until("the end of all", lambda: not any(is_running(pid) for pid in started))
