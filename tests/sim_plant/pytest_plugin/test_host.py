"""Nothing that the plugin starts outlives the tests, whatever becomes of them."""

import json
import os
import signal
import subprocess
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


@pytest.fixture(scope="module")
def host(tmp_path_factory):
    """One process for all tests that leave it whole, and for the one that loses it."""
    made = HostClient(
        tmp_path_factory.mktemp("host"), module="tests.sim_plant.pytest_plugin.small_host"
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(ROOT))
        yield made
    made.close()


def test_a_host_whose_tests_are_gone_ends_its_plants_and_itself(tmp_path, monkeypatch):
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    host = HostClient(tmp_path, module="tests.sim_plant.pytest_plugin.small_host")
    plant = WebLine(host, LineSetup())._plant
    host._process.stdin.close()
    assert host._process.wait(PATIENCE_s) == 0
    assert _is_gone(plant)
    host._process.stdout.close()


class Interrupted(BaseException):
    pass


def test_a_test_that_is_interrupted_at_its_first_line_leaves_the_next_ones_whole(host):
    def interrupt(*_):
        raise Interrupted

    before = signal.signal(signal.SIGALRM, interrupt)
    try:
        for after_s in (0.01, 0.1, 0.3, 0.6):
            signal.setitimer(signal.ITIMER_REAL, after_s)
            try:
                with pytest.raises(Interrupted):
                    _lines_for_ever(host)
            finally:
                signal.setitimer(signal.ITIMER_REAL, 0)
            line = WebLine(host, LineSetup())
            assert line.step(3) == pytest.approx(4 * line.sample_time_s)
            line.close()
            assert not _children_of(host._process.pid)
    finally:
        signal.signal(signal.SIGALRM, before)


def test_an_answer_that_nobody_waited_for_is_dropped_and_its_plant_ended(host, tmp_path):
    WebLine(host, LineSetup()).close()
    late = LineSetup().serve_words(tmp_path)
    request = {"serve": late, "log": str(tmp_path / "late"), "number": 0}
    host._process.stdin.write(json.dumps(request).encode() + b"\n")
    line = WebLine(host, LineSetup())
    assert _children_of(host._process.pid) == [line._plant]
    line.close()


def test_a_log_that_cannot_be_written_is_told_at_once_and_the_next_line_is_served(host, tmp_path):
    with pytest.raises(PlantError, match="No such file or directory"):
        host.serve(LineSetup().serve_words(tmp_path), tmp_path / "none" / "log")
    WebLine(host, LineSetup()).close()


def test_a_value_arrives_with_all_its_digits_and_what_is_none_is_refused(host):
    line = WebLine(host, LineSetup())
    try:
        line.set("tension_ref_N", 75.123456789)
        assert line.value("tension_ref_N") == 75.123456789
        line.set("WEB_INTACT", 0.0)
        assert "WEB_INTACT" not in line.status().status
        with pytest.raises(PlantError, match="'75 N' is no number; give one in SI units"):
            line.set("tension_ref_N", "75 N")
    finally:
        line.close()


def test_a_command_that_is_refused_is_named_once(host):
    line = WebLine(host, LineSetup())
    try:
        with pytest.raises(PlantError, match=r"^value speed: no such channel"):
            line.value("speed")
        with pytest.raises(PlantError, match=r"^fault 'melt': unknown name"):
            line.inject("melt")
        with pytest.raises(PlantError, match=r"^sett 1: unknown command"):
            line.tell("sett 1")
    finally:
        line.close()


def test_a_line_that_crashes_says_by_which_signal_at_the_command_and_at_its_end(host):
    line = WebLine(host, LineSetup())
    os.kill(line._plant, signal.SIGSEGV)
    for told, begins in ((line.step, "step 1: the line is"), (line.close, "the line is")):
        with pytest.raises(
            PlantError, match=rf"^{begins} gone \(ended by SIGSEGV\); (?s:.*)ready"
        ):
            told()
    line.close()


class OfOneThatCrashes:
    """A host whose plant is ended by a signal before it has said a word."""

    def serve(self, words, log):
        self.plant = subprocess.Popen(["/bin/sh", "-c", "kill -s SEGV $$"])
        return self.plant.pid

    def end(self, plant):
        return self.plant.wait(PATIENCE_s)


def test_a_line_that_crashes_before_it_is_ready_is_told_and_not_waited_for():
    with pytest.raises(PlantError, match=r"cannot be served \(ended by SIGSEGV\); it said:"):
        WebLine(OfOneThatCrashes(), LineSetup())


def test_a_killed_host_takes_its_plants_along_tells_the_test_and_another_follows(host):
    line = WebLine(host, LineSetup())
    plant, process = line._plant, host._process
    assert not _is_gone(plant)
    os.kill(process.pid, signal.SIGKILL)
    _wait_until_gone(plant)
    for told in (line.step, line.close):
        with pytest.raises(PlantError, match=r"gone .*ended by signal 9; it said nothing"):
            told()
    other = WebLine(host, LineSetup())
    assert host._process.pid != process.pid
    other.step()
    other.close()


@pytest.mark.long  # a third host; quick: a killed one, above
def test_a_host_that_was_killed_between_two_lines_is_missed_before_anything_is_asked(host):
    other = WebLine(host, LineSetup())
    os.kill(host._process.pid, signal.SIGKILL)
    host._process.wait(PATIENCE_s)
    line = WebLine(host, LineSetup())
    with pytest.raises(PlantError, match="is no line of this host"):
        other.close()
    line.step()
    line.close()


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"can": "canfd"}, "can='canfd': write dbc or canopen"),
        ({"words": "--no-fc23"}, "words='--no-fc23': give a tuple of words"),
    ],
)
def test_a_setting_that_makes_no_sense_is_refused_with_what_to_write(settings, said):
    with pytest.raises(PlantError, match=said):
        LineSetup(**settings)


def test_a_relative_path_is_that_of_the_test_wherever_the_host_is(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = LineSetup(line=Path("mine.yaml"), plc=Path("map.yaml")).serve_words(Path("/x"))
    assert words[0] == str(tmp_path / "mine.yaml")
    assert words[words.index("--plc") + 1] == str(tmp_path / "map.yaml")


def _lines_for_ever(host):
    while True:
        WebLine(host, LineSetup()).close()


def _children_of(process):
    children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    return [int(child) for child in children if not _is_gone(child)]
