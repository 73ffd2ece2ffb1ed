"""Nothing that the plugin starts outlives the tests, whatever becomes of them."""

import os
import signal
import time
from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.pytest_plugin.host_client import HostClient
from sim_plant.pytest_plugin.web_line import LineSetup, WebLine

pytestmark = [pytest.mark.wire, pytest.mark.processes, pytest.mark.timeout(60)]

PATIENCE_s = 10.0
ROOT = Path(__file__).parents[3]


def _is_gone(process):
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except FileNotFoundError:
        return True


def _wait_until_gone(process):
    give_up = time.monotonic() + PATIENCE_s
    while not _is_gone(process):
        assert time.monotonic() < give_up, f"process {process} is still there"
        time.sleep(0.01)


def test_a_host_that_is_killed_takes_its_plants_along_and_the_test_is_told(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    host = HostClient(tmp_path, module="tests.sim_plant.pytest_plugin.small_host")
    line = WebLine(host, LineSetup())
    plant, process = line._plant, host._process
    assert not _is_gone(plant)
    os.kill(process.pid, signal.SIGKILL)
    _wait_until_gone(plant)
    with pytest.raises(PlantError, match="the line is gone"):
        line.step()
    with pytest.raises(PlantError, match="the process of the simulated lines ended"):
        line.close()
    host.close()


def test_a_host_whose_tests_are_gone_ends_its_plants_and_itself(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    host = HostClient(tmp_path, module="tests.sim_plant.pytest_plugin.small_host")
    plant = WebLine(host, LineSetup())._plant
    host._process.stdin.close()
    assert host._process.wait(PATIENCE_s) == 0
    assert _is_gone(plant)
    host._process.stdout.close()
