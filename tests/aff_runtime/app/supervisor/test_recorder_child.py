"""What the supervisor says to a recorder that does not listen for a while."""

import hashlib
import os
import signal
from pathlib import Path
from types import SimpleNamespace

import pytest

from aff_runtime.app.supervisor import processes
from aff_runtime.app.supervisor.recorder_child import RecorderChild
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.base.signals import State
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RecorderReport, RunContext
from aff_runtime.telemetry.ring import RingReader, RingWriter
from aff_runtime.telemetry.run_folder import RunFolder
from aff_runtime.telemetry.takeover import takeover_of
from tests.aff_runtime.app.supervisor.whole import Whole
from tests.processes import until

COUNT, SIZE = 8, 200_000
"""Site files of 200 kB: more together than the pipe to the recorder holds."""


@pytest.mark.processes
def test_site_files_that_the_pipe_has_no_room_for_come_whole_and_in_order(tmp_path: Path) -> None:
    ring = RingWriter(["time_s", "tick", "state"], meta=RunMeta(start_ns=1000))
    reader = RingReader(ring.open_for_readers())
    ring.write((0.0, 0.0, 4.0))
    child = RecorderChild(reader, tmp_path, RunContext(name="Line", site_text="a: 1\n"))
    try:
        until("it writes", lambda: bool(list(tmp_path.glob("*/events.csv"))))
        os.kill(child.pid, signal.SIGSTOP)
        texts = {f"{k:012x}": f"a: {'x' * SIZE}{k}\n" for k in range(COUNT)}
        for site_hash, text in texts.items():
            child.note("CONFIG_APPLIED", site_hash, site_text=text, site_hash=site_hash)
        os.kill(child.pid, signal.SIGCONT)
        last = f"*/site-{list(texts)[-1]}.yaml"
        until("it has them", lambda: child.report().alive and bool(list(tmp_path.glob(last))))
    finally:
        os.kill(child.pid, signal.SIGCONT)
        ring.close()
        child.wait(20.0)
        reader.close()
    (folder,) = tmp_path.iterdir()
    assert {name: (folder / f"site-{name}.yaml").read_text() for name in texts} == texts
    rows = (folder / "events.csv").read_text().splitlines()[1:]
    assert [row.rsplit(",", 1)[1] for row in rows] == list(texts)


def test_with_what_is_applied_the_recorder_gets_the_text_that_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, said = Whole(tmp_path, monkeypatch), []
    recorder = SimpleNamespace(note=lambda *words, **more: said.append((words, more)))
    monkeypatch.setattr(whole.children, "_recorder", recorder)
    whole.children.note_applied()
    monkeypatch.setattr(whole.children, "_recorder", None)
    whole.stop()
    runs = whole.children.parameters
    assert runs.site_text == whole.site.read_text()
    ((words, more),) = said
    assert words[0] == "CONFIG_APPLIED"
    assert f"site {runs.site_hash[:12]};" in words[1]
    digest = hashlib.sha256(whole.site.read_bytes()).hexdigest()
    assert words[1].endswith(f"; text sha256 {digest[:12]}")
    assert more == {"site_text": runs.site_text, "site_hash": runs.site_hash}


class RecorderHere:
    """A recorder in this process; one that ``hears`` nothing hangs."""

    pid = 4712
    hears = True

    def __init__(self, ring: RingReader, directory: Path, context: RunContext) -> None:
        self.ring, self.alive = ring, True
        taken = takeover_of(context, ring.header)
        self.folder = RunFolder(directory, ring.header, context, taken)
        self.folder.add(ring.signals.read_new())

    def note(self, name: str, text: str, *, site_text: str = "", site_hash: str = "") -> None:
        if self.hears:
            self.folder.keep_site(site_hash, site_text)
            self.folder.add_note(name, text)

    def report(self) -> RecorderReport:
        return RecorderReport(folder=str(self.folder.path), alive=self.alive)

    def how_it_ended(self) -> str:
        return "recorder 4712: killed by SIGKILL"

    def wait(self, _: float) -> None:
        self.folder.signals.close()


def test_what_was_applied_while_the_recorder_hung_is_named_by_the_one_that_follows(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = Whole(tmp_path, monkeypatch)
    monkeypatch.setattr(processes, "RecorderChild", RecorderHere)
    children = whole.children
    assert children.ring is not None
    for k in range(4):
        whole.tick(State.READY, tick=float(k))
        whole.clock.advance_ns(5_000_000)
    children._start_recorder(children.ring)
    first = children._recorder
    assert isinstance(first, RecorderHere)
    first.hears = False
    began = children.parameters
    text = began.site_text.replace("limit_m_s: 0.05", "limit_m_s: 0.12")
    children.parameters = began.model_copy(update={"site_text": text, "site_hash": "ab" * 32})
    children.note_applied()
    first.alive = False
    children._look_after_recorder()
    whole.stop()
    sites = read_table(run_window(first.folder.path)).sites
    assert [one.text for one in sites] == [began.site_text, text]
