"""The process that checks a site file: bounded, ended in time, and what is said of its end."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from typing import cast

import pytest

from aff_runtime.app.check.limits import MEMORY_BYTES, PATIENCE_S, PROCESSOR_S
from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.check.validate import check_result
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.runtime_directory import runtime_paths
from aff_runtime.app.supervisor import edit_session, supervisor, validation
from aff_runtime.app.supervisor.edit_session import EditSession
from aff_runtime.app.supervisor.file_watch import FileWatch
from aff_runtime.app.supervisor.pending import Pending
from aff_runtime.app.supervisor.processes import Processes
from aff_runtime.app.supervisor.response_ledger import ResponseLedger
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.validation import (
    MAX_FINDING_LENGTH,
    MAX_FINDINGS,
    Validation,
    load_parameters,
)
from aff_runtime.base.errors import ConfigError
from tests.aff_runtime.config.shipped import edited
from tests.doubles.virtual_clock import VirtualClock
from tests.processes import until
from tests.security.learned_files import CheckInProcess

pytestmark = pytest.mark.processes

ROOT = Path(__file__).parents[2]
SITE = ROOT / "config" / "euclid.yaml"

BOUND = """
import resource, sys
from aff_runtime.app.check import limits, validate
from aff_runtime.app.check.result import CheckResult
"""
HUNGRY = {
    "memory": (
        BOUND
        + "validate.check_result = lambda *_: bytearray(2 << 30)\nvalidate.main(sys.argv[1:])\n",
        "the check needs more than 1 GB of memory. A file that it names is too large",
    ),
    "processor time": (
        BOUND + "limits.PROCESSOR_S = 1\nlimits.bound_this_process()\nwhile True: pass\n",
        "the check took more than 20 s of processor time. A file that it names is too large",
    ),
    "an end by somebody": (
        "import os, signal\nos.kill(os.getpid(), signal.SIGKILL)\n",
        "the check was ended by SIGKILL.",
    ),
    "an end in itself": ("raise SystemExit(9)\n", "the check itself failed (exit 9)"),
    "a release of its own": (
        'print(\'{"record": {"site": {}}, "findings": []}\')\n',
        "the check is of another release than this service. Restart the service.",
    ),
    "half an answer": ("print('{\"record\": 1', end='')\n", "the check itself failed (exit 0)"),
}


def instead(monkeypatch: pytest.MonkeyPatch, script: str) -> None:
    """Have another program run in the place of the check."""
    command = [sys.executable, "-P", "-c", script]
    monkeypatch.setattr(validation, "module_command", lambda _: command)


@pytest.mark.parametrize("name", HUNGRY)
@pytest.mark.sweep(every=2)
def test_a_check_that_dies_says_in_words_of_what(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    script, said = HUNGRY[name]
    instead(monkeypatch, script)
    with pytest.raises(ConfigError) as caught:
        load_parameters(tmp_path / "site.yaml")
    assert str(caught.value).startswith(f"{tmp_path}/site.yaml:1:1  {said}")


def test_the_check_bounds_itself_before_it_reads(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    look = """
def look(*_):
    said = [str(resource.getrlimit(kind)[0]) for kind in (resource.RLIMIT_AS, resource.RLIMIT_CPU)]
    with open("/proc/self/oom_score_adj") as file:
        return CheckResult(parameters=None, findings=(*said, file.read().strip()))
validate.check_result = look
validate.main(sys.argv[1:])
"""
    instead(monkeypatch, BOUND + look)
    found = Validation(tmp_path / "site.yaml").result(wait_s=PATIENCE_S)
    assert found is not None
    assert found.findings == (str(MEMORY_BYTES), str(PROCESSOR_S), "1000")


# quick, of one of them: app/supervisor/test_validation.py
@pytest.mark.long
@pytest.mark.parametrize("name", ["euclid.yaml", "euclid_can.yaml", "euclid_canopen.yaml"])
def test_every_shipped_site_is_checked_well_within_the_bounds(name: str) -> None:
    assert load_parameters(ROOT / "config" / name).parameters is not None


def test_a_check_that_hangs_is_ended_after_its_patience_and_that_is_the_result() -> None:
    clock = VirtualClock()
    check = Validation(SITE, clock=clock)
    os.kill(check.pid, signal.SIGSTOP)
    assert check.result() is None
    clock.advance_ns(int(PATIENCE_S * 1e9) - 1)
    assert check.result() is None
    clock.advance_ns(1)
    said = check.result()
    assert said is not None
    assert said.parameters is None
    assert said.findings[0].startswith(
        f"{SITE}:1:1  the check took longer than 30 s and was ended"
    )
    assert not Path(f"/proc/{check.pid}").exists()


def test_a_start_does_not_wait_for_a_check_without_end(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    instead(monkeypatch, "import signal\nsignal.pause()\n")
    monkeypatch.setattr(validation, "PATIENCE_S", 0.3)
    with pytest.raises(ConfigError, match="the check took longer than"):
        load_parameters(tmp_path / "site.yaml")


class Running:
    """The processes of a service as far as an edit session sees them."""

    def __init__(self, parameters: ParameterRecord) -> None:
        self.parameters = parameters
        self.control = None
        self.probed = ResponseLedger(lambda text: self.note("PROBE", text))
        self.notes: list[tuple[str, str]] = []

    def note(self, name: str, text: str) -> None:
        """Keep a note."""
        self.notes.append((name, text))

    def is_live(self) -> bool:
        """Nothing goes out."""
        return False


def test_an_edit_whose_check_hangs_is_told_and_the_next_one_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = edited(tmp_path)
    first = check_result(path)
    assert first.parameters is not None
    running = Running(first.parameters)
    clock = VirtualClock()
    monkeypatch.setattr(
        edit_session, "Validation", lambda site, state: Validation(site, state, clock)
    )
    edits = EditSession(cast(Processes, running), Pending(clock), path, first)

    path.write_text(path.read_text().replace("settle_s: 6,", "settle_s: 7,"))
    until("the edit is seen", lambda: edits.step() is None and edits.is_busy)
    os.kill(_under_way(edits), signal.SIGSTOP)
    edits.step()
    clock.advance_ns(int(PATIENCE_S * 1e9))
    edits.step()
    assert not edits.is_busy
    assert running.parameters is first.parameters
    assert "the check took longer than 30 s" in edits.differs[0]
    assert ("CONFIG_DIFFERS", edits.differs[0]) in running.notes

    edits.look_again()
    until("the edit is taken", lambda: edits.step() is None and not edits.is_busy)
    assert edits.differs == ()
    assert running.parameters.config_hash != first.parameters.config_hash


def _under_way(edits: EditSession) -> int:
    check = edits._check
    assert check is not None
    return check.pid


def test_an_edit_saved_while_the_service_starts_is_taken_like_any_other(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(edit_session, "Validation", CheckInProcess)
    path = edited(tmp_path)
    watch = FileWatch([path])
    first = check_result(path)
    assert first.parameters is not None
    path.write_text(path.read_text().replace("settle_s: 6,", "settle_s: 7,"))
    running = Running(first.parameters)
    pending = Pending(VirtualClock())
    edits = EditSession(cast(Processes, running), pending, path, first, watch=watch)

    text = path.read_text()
    until(
        "the edit is taken", lambda: edits.step() is None and running.parameters.site_text == text
    )


def test_the_service_looks_at_its_file_before_the_check_reads_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = edited(tmp_path)

    def slow(site: Path, state: Path) -> CheckResult:
        found = check_result(site, state)
        site.write_text(site.read_text() + "# saved while the check ran\n")
        return found

    monkeypatch.setattr(supervisor, "load_parameters", slow)
    paths = runtime_paths(tmp_path / "rt")
    paths.directory.mkdir(mode=0o700)
    service = supervisor.Supervisor(RunOptions(site=path, paths=paths))
    try:
        service._edits.step()
        assert service._edits.is_busy
    finally:
        service._shut_down()


def test_a_thousand_findings_do_not_fill_log_record_and_status(tmp_path: Path) -> None:
    path = edited(tmp_path)
    path.write_text(path.read_text() + "".join(f"k{i}: 1\n" for i in range(1000)))
    found = Validation(path).result(wait_s=PATIENCE_S)
    assert found is not None
    assert found.parameters is None
    assert len(found.findings) == MAX_FINDINGS + 1
    assert found.findings[-1].endswith("950 more; `aff-runtime check` names every one")


def test_a_finding_that_quotes_without_end_is_cut(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    said = "import json\nprint(json.dumps({'record': None, 'findings': ['x' * 100000]}))\n"
    instead(monkeypatch, said)
    found = Validation(tmp_path / "site.yaml").result(wait_s=PATIENCE_S)
    assert found is not None
    assert len(found.findings[0]) == MAX_FINDING_LENGTH
