"""Settings that a running service tries: the way back is its own, on a real wire.

Quick is each of these in virtual time, ``supervisor/settings/test_desk.py``; what is killed in a
try, ``test_commissioning_kills.py``.
"""

from __future__ import annotations

import contextlib
import hashlib
import io
import os
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError, RefusedError
from aff_runtime.base.runs.site_in_force import SiteInForce
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.cli.main import main
from tests.aff_runtime.app.service_run import ServiceRun
from tests.processes import until

pytestmark = [pytest.mark.long, pytest.mark.wire]
OLD, NEW = "settle_s: 6,", "settle_s: 12,"
LINE = "actuators.unwind.blocks[0].settle_s: 6 s -> 12 s (applies at once)"


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceRun]:
    run = ServiceRun(tmp_path_factory.mktemp("service"), "--state-dir", "/nowhere")
    yield run
    run.close()


def words_of(service: ServiceRun, *words: str) -> list[str]:
    return ["settings", *words, "--runtime-dir", str(service.runtime_dir)]


def console(service: ServiceRun, *words: str) -> tuple[int, str]:
    """Give one command as a technician does; return its exit code and what it said."""
    said = io.StringIO()
    with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
        code = main(words_of(service, *words))
    return code, said.getvalue()


def console_that_ends(service: ServiceRun, *words: str) -> tuple[int, str]:
    """The same in a process of its own, which is gone afterwards."""
    done = subprocess.run(
        [sys.executable, "-m", "aff_runtime.cli.main", *words_of(service, *words)],
        capture_output=True,
        text=True,
        check=False,
        timeout=60,
    )
    return done.returncode, done.stdout + done.stderr


def other(service: ServiceRun, before: str = OLD, after: str = NEW) -> Path:
    """Write the site file with one value changed beside it."""
    text = service.site.read_text()
    assert before in text
    path = service.folder / "new.yaml"
    path.write_text(text.replace(before, after, 1))
    return path


def verbs(service: ServiceRun) -> list[str]:
    return [row["verb"] for row in service.ask("settings", act="history")["versions"]]


def test_a_diff_says_what_changes_with_units_and_changes_nothing(service: ServiceRun) -> None:
    before = service.status()["config_hash"]
    assert console(service, "diff", str(other(service))) == (0, f"{LINE}\n")
    wrong = other(service, "\n  cycle_ms: 20\n", "\n  cycle_ms: 0\n")
    code, said = console(service, "diff", str(wrong))
    assert code == 2
    assert f"{service.site}:" in said
    assert "cycle_ms" in said
    assert service.status()["config_hash"] == before


def test_a_try_returns_by_itself_after_its_console_is_gone(service: ServiceRun) -> None:
    before = service.status()["config_hash"]
    text = service.site.read_bytes()
    code, said = console_that_ends(
        service, "try", str(other(service)), "--seconds", "5", "--why", "hunting at 1x"
    )
    assert code == 0
    assert LINE in said
    assert service.status()["config_hash"] != before
    assert 0.0 < service.status()["trying_left_s"] <= 5.0
    with pytest.raises(RefusedError, match="are being tried; keep or undo them first"):
        service.ask("probe")
    until("the former settings", lambda: service.status()["config_hash"] == before)
    until("its end", lambda: service.status()["trying"] == "")
    assert service.site.read_bytes() == text
    assert verbs(service)[-2:] == ["tried", "returned"]
    assert service.said("returned by the service: its time is up")


def test_the_run_has_the_text_of_a_try_and_when_it_ran(service: ServiceRun) -> None:
    text, new = service.site.read_text(), other(service, OLD, "settle_s: 11,")
    tried = console(service, "try", str(new), "--seconds", "5", "--why", "hunting at 1x")
    assert tried[0] == 0
    until("its end", lambda: service.status()["trying"] == "")
    run = Path(service.status()["recorder"]["folder"])
    ran = [text, new.read_text(), text]
    until("it is noted", lambda: [one.text for one in sites(run)][-3:] == ran)
    before, tried_s, after = (one.from_s for one in sites(run)[-3:])
    assert before < tried_s < after
    assert read_table(run_window(f"{run}@{tried_s + 1.0}..")).site_text == new.read_text()


def sites(run: Path) -> tuple[SiteInForce, ...]:
    return read_table(run_window(run), keep=lambda name: name == "time_s").sites


def test_a_try_that_is_kept_becomes_the_site_file_and_can_be_undone(service: ServiceRun) -> None:
    text, before = service.site.read_text(), service.status()["config_hash"]
    new = other(service)
    assert console(service, "try", str(new), "--seconds", "30", "--why", "hunting at 1x")[0] == 0
    code, said = console(service, "keep", str(service.site), "--why", "3 dB less at 1x")
    assert (code, said) == (0, f"kept; saved in {service.site}\n")
    assert service.site.read_text() == text.replace(OLD, NEW, 1)
    until("no difference", lambda: not service.status()["config_differs"])
    assert service.status()["config_hash"] != before
    row = service.ask("settings", act="history")["versions"][-1]
    assert (row["verb"], row["why"]) == ("kept", "3 dB less at 1x")
    assert f"uid {os.geteuid()}" in row["who"] or "via" in row["who"]
    assert "pid " in row["who"]
    code, said = console(service, "undo", str(service.site), "--why", "noise grew at night")
    assert (code, said) == (0, f"undone; saved in {service.site}\n")
    assert service.site.read_text() == text
    assert service.status()["config_hash"] == before
    assert verbs(service)[-1] == "undone"
    code, said = console(service, "history")
    assert "undone by" in said.splitlines()[-1]
    assert "noise grew at night" in said.splitlines()[-1]


def test_ripple_that_rises_in_a_try_brings_the_former_settings_back(service: ServiceRun) -> None:
    before = service.status()["config_hash"]
    MonotonicClock().sleep_until_ns(MonotonicClock().now_ns() + 6_000_000_000)
    assert console(service, "try", str(other(service)), "--why", "hunting at 1x")[0] == 0
    service.tell_plc("shake 12")
    try:
        until("the former settings", lambda: service.status()["config_hash"] == before)
        until("its end", lambda: service.status()["trying"] == "")
        assert service.said("returned by the service: ripple of unwind_tension_N rose from 2.")
    finally:
        service.tell_plc("shake 3")


def test_of_two_tries_at_once_one_runs_and_the_other_is_refused(service: ServiceRun) -> None:
    before, new = service.status()["config_hash"], other(service).read_text()
    asked = {"act": "try", "text": new, "seconds": 5.0, "why": "hunting at 1x"}

    def ask(_: int) -> str:
        try:
            service.ask("settings", **asked)
        except RefusedError as error:
            return str(error)
        return "tried"

    with ThreadPoolExecutor(4) as pool:
        said = list(pool.map(ask, range(4)))
    assert said.count("tried") == 1
    assert all("keep or undo them first" in one for one in said if one != "tried")
    until("the former settings", lambda: service.status()["config_hash"] == before)
    assert verbs(service)[-2:] == ["tried", "returned"]


def test_a_site_file_saved_in_a_try_ends_it_and_is_judged_after_the_return(
    service: ServiceRun,
) -> None:
    text = service.site.read_text()
    assert console(service, "try", str(other(service)), "--why", "hunting at 1x")[0] == 0
    service.edit("settle_s: 6,", "settle_s: 9,")
    until("its end", lambda: service.status()["trying"] == "")
    assert service.said("returned by the service: a file was saved meanwhile")
    until("the edit", lambda: verbs(service)[-1] == "edited")
    assert service.ask("settings", act="history")["versions"][-1]["sha256"] == (
        hashlib.sha256(service.site.read_bytes()).hexdigest()
    )
    service.edit("settle_s: 9,", "settle_s: 6,")
    until("as it was", lambda: not service.status()["config_differs"] and verbs(service)[-3:])
    assert service.site.read_text() == text
    until("both edits", lambda: verbs(service)[-2:] == ["edited", "edited"])


@pytest.mark.parametrize(
    "after", ["settle_s: .nan,", "settle_s: \ud800,", "settle_s: 6, # \ud800"]
)
def test_a_hostile_text_is_refused_and_the_service_goes_on(
    service: ServiceRun, after: str
) -> None:
    before, pid = service.status()["config_hash"], service.status()["control_pid"]
    text = service.site.read_text().replace(OLD, after, 1)
    with pytest.raises(AffError) as refused:
        service.ask("settings", act="try", text=text, seconds=5.0, why="hunting at 1x")
    assert f"{service.site}:" in str(refused.value)
    assert service.status()["trying"] == ""
    assert (service.status()["config_hash"], service.status()["control_pid"]) == (before, pid)


def test_keep_writes_only_the_file_that_its_caller_names(service: ServiceRun) -> None:
    new = other(service)
    before = new.read_text()
    assert console(service, "try", str(new), "--why", "hunting at 1x")[0] == 0
    code, said = console(service, "keep", str(new), "--why", "3 dB less at 1x")
    assert code == 2
    assert f"the service runs on {service.site}" in said
    assert new.read_text() == before
    assert OLD in service.site.read_text()
    assert console(service, "undo", str(service.site), "--why", "enough seen")[0] == 0
