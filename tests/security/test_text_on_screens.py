"""Words of others in logs, terminals, events and records: one line, and nothing that acts."""

from __future__ import annotations

import ast
import csv
import json
import logging
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.report.status_answer import read_answer
from aff_runtime.app.supervisor.service_log import OneLine, open_log
from aff_runtime.base.errors import ConfigError
from aff_runtime.cli.main import main
from aff_runtime.cli.top import screen
from aff_runtime.config.declared import walk
from aff_runtime.config.loader import load_site
from aff_runtime.config.models import Site
from aff_runtime.config.quantity import Name, Text
from aff_runtime.telemetry.header import Right, RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
from tests import quick_yaml
from tests.aff_runtime.telemetry.heads import head_of
from tests.house.trees import tree_of
from tests.security.desk import answering

ROOT = Path(__file__).parents[2]
SITE = ROOT / "config" / "euclid_blocks.yaml"
FORGED = "INFO OPERATOR: arm by shift leader"
HOSTILE = {
    "newline": f"Eu\n{FORGED}",
    "carriage return": f"Eu\r{FORGED}",
    "escape": "Eu\x1b[2J\x1b]0;title\x07clid",
    "C1 escape": "Eu\x9b2Jclid",
    "right to left": "Eu\u202edilc",
    "line separator": f"Eu\u2028{FORGED}",
    "paragraph separator": f"Eu\u2029{FORGED}",
    "next line": f"Eu\x85{FORGED}",
    "zero width": "Eu\u200bclid\ufeff",
    "NUL": "Eu\0clid",
    "lone surrogate": "Eu\udc80clid",
}
hostile = pytest.mark.parametrize("text", HOSTILE.values(), ids=HOSTILE.keys())


def assert_harmless(said: str, lines: int) -> None:
    """``said`` has so many lines, and nothing in it but what shows as itself."""
    rows = said.split("\n")
    assert rows.pop() == ""
    assert len(rows) == lines
    assert all(row.isprintable() for row in rows)


# --- site file ------------------------------------------------------------------------------


@hostile
def test_free_text_of_the_site_file_that_does_not_print_is_refused_at_its_place(
    tmp_path: Path, text: str
) -> None:
    quoted = "".join(c if c.isascii() and c.isprintable() else f"\\u{ord(c):04x}" for c in text)
    site = tmp_path / "site.yaml"
    given = SITE.read_text()
    shipped = re.search(r"\n  name: .*", given)
    assert shipped is not None
    site.write_text(given.replace(shipped[0], f'\n  name: "{quoted}"', 1))
    line = given[: shipped.start() + 1].count("\n") + 1
    with pytest.raises(ConfigError) as refused:
        load_site(site)
    said = str(refused.value)
    assert said.isprintable()
    assert re.match(rf"{re.escape(str(site))}:{line}:\d+  ", said)
    assert re.search(r"which does not print|control character|invalid Unicode", said)


def test_every_free_text_of_the_site_file_is_of_the_kind_that_prints() -> None:
    kinds = [Text.__metadata__, Name.__metadata__]
    free = {}
    for path, key in walk(Site):
        declared = key
        while declared.item is not None and declared.item.section is None:
            declared = declared.item
        if declared.leaf is str:
            free[path] = declared.metadata
    assert len(free) > 20
    for path, metadata in free.items():
        assert any(all(mark in metadata for mark in kind) for kind in kinds), path


@hostile
def test_a_file_name_cannot_forge_a_finding(
    tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / text.replace("\0", "").replace("/", "")
    site = folder / "site.yaml"
    try:
        folder.mkdir()
        site.write_text("version: 2\n")
    except (OSError, ValueError):
        pytest.skip("no file system takes such a name")
    with pytest.raises(ConfigError) as refused:
        load_site(site)
    assert all(
        isinstance(row, str) and row.isprintable() for row in str(refused.value).split("\n")
    )
    assert all(row.startswith("/") for row in str(refused.value).split("\n"))
    assert main(["check", str(site), "--brief"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert_harmless(said.err, said.err.count("\n"))
    assert not any(row.startswith(FORGED) for row in said.err.splitlines())


# --- the log --------------------------------------------------------------------------------


@hostile
def test_a_record_of_the_log_is_one_line(text: str) -> None:
    made = OneLine("%(levelname)s %(message)s").format(
        logging.LogRecord("x", logging.INFO, "", 0, "EDIT: %s", (text,), None)
    )
    assert made.isprintable()
    assert made.startswith("INFO EDIT: Eu")


def test_the_service_logs_through_that_form_and_no_other(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    root = logging.getLogger()
    monkeypatch.setattr(root, "handlers", [])
    monkeypatch.setattr(root, "level", logging.WARNING)
    open_log({"JOURNAL_STREAM": "8:9"})
    logging.getLogger("of.a.library").warning("a frame named %s", HOSTILE["newline"])
    said = capsys.readouterr().err
    assert said == f"WARNING a frame named Eu\\n{FORGED}\n"
    assert all(isinstance(handler.formatter, OneLine) for handler in root.handlers)


# --- the record -----------------------------------------------------------------------------


@hostile
def test_events_and_the_head_of_a_record_hold_it_escaped(tmp_path: Path, text: str) -> None:
    meta = RunMeta(versions={text: text}, rights=(Right(granted=True, text=text),))
    header = head_of(meta, "2026-01-02T03:04:05.678")
    context = RunContext(name=text, site_file=text, learned={text: {text: text}})
    folder = RunFolder(tmp_path, header, context)
    folder.add_note("EDIT", text)
    folder.add_note(text, "x")
    folder.finish(ring_overruns=0)
    events = (folder.path / "events.csv").read_text(encoding="utf-8")
    assert_harmless(events, 3)
    assert [row["text"][:2] for row in csv.DictReader(events.splitlines())] == ["Eu", "x"]
    head = (folder.path / "run.yaml").read_text(encoding="utf-8")
    assert all(row.isprintable() for row in head.split("\n"))
    about = quick_yaml.safe_load(head)
    assert about["name"].isprintable()
    assert about["rights"][0]["text"].startswith("Eu")


# --- the terminal ---------------------------------------------------------------------------


def answer(text: str) -> dict[str, Any]:
    """A status in which every text is hostile."""
    block = {
        "actuator": text,
        "name": text,
        "roll": text,
        "order": 1,
        "state": text,
        "why": text,
        "frequency_Hz": 1.0,
        "amplitude": 0.001,
        "unit": "m/s",
        "limit": 0.02,
        "out": 1.0,
        "phase_deg": 3.0,
        "encoder_deg": None,
        "ripple_before": 1.0,
        "ripple": 0.1,
        "benefit_dB": 20.0,
        "ripple_unit": text,
        "law": "blocks",
    }
    return {
        "ok": True,
        "line": text,
        "state": "ACTIVE",
        "blocked_by": text,
        "alarm": {"code": 0},
        "comm": text,
        "config_hash": text,
        "config_differs": [text],
        "control_pid": 7,
        "signals": {
            "age_s": 0.004,
            "io_us": 1.0,
            "tick_us": 1.0,
            "missed_count": 0.0,
            f"{text}_tension_N": 88.9,
            "correction_unwind_m_s": 0.0,
        },
        "blocks": [block],
        "wire": [text],
        "crossings": [text],
        "shapes": [text],
        "recorder": {"folder": text, "rows": 10, "alive": True},
    }


@pytest.fixture
def place(tmp_path: Path) -> Path:
    folder = tmp_path / "rt"
    folder.mkdir(mode=0o700)
    return folder


@pytest.mark.wire
@hostile
@pytest.mark.parametrize("command", [["status"], ["status", "--json"]])
@pytest.mark.sweep(every=6)
def test_what_the_service_answers_reaches_the_terminal_as_plain_lines(
    place: Path, text: str, command: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    counts = []
    for words in ("Euclid", text):
        with answering(place / "control.sock", answer(words)):
            assert main([*command, "--runtime-dir", str(place)]) == 0
        said = capsys.readouterr().out
        counts.append(said.count("\n"))
        assert_harmless(said, counts[0])
    assert len(set(counts)) == 1


@hostile
def test_a_device_profile_cannot_add_lines_of_its_own(
    tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    shipped = sorted((ROOT / "config" / "devices").glob("*.yaml"))[0]
    rows = quick_yaml.safe_load(shipped.read_text())
    profile = tmp_path / "device.yaml"
    counts = []
    for words in ("plain", text.replace("\udc80", "?")):  # no file has a lone surrogate
        profile.write_text(
            json.dumps({**rows, "device": words, "manual": words + " of it, page 1"})
        )
        code, shown = main(["map", "--device", str(profile)]), capsys.readouterr()
        if code:  # a control character is refused at each place where it stands
            assert_harmless(shown.err, 2)
            return
        counts.append(shown.out.count("\n"))
        assert_harmless(shown.out, counts[0])


@hostile
def test_the_live_screen_keeps_its_rows_and_its_width(text: str) -> None:
    rows = screen(read_answer(answer(text)))
    assert (
        len(rows) <= len(screen(read_answer(answer("Euclid")))) + 1 <= 24
    )  # the headline may take two
    assert all(row.isprintable() and len(row) <= 80 for row in rows)


@pytest.mark.wire
@hostile
@pytest.mark.sweep(every=4)
def test_the_page_of_the_rolls_holds_it_escaped(place: Path, text: str) -> None:
    out = place.parent / "roll.html"
    with answering(place / "control.sock", answer(f"<img src=x onerror=y>{text}")):
        assert main(["roll", "--out", str(out), "--runtime-dir", str(place)]) == 0
    page = out.read_text(encoding="utf-8")
    assert all(row.isprintable() for row in page.split("\n"))
    assert "<img" not in page
    assert not any(row.startswith(FORGED) for row in page.splitlines())


@pytest.mark.wire
@hostile
@pytest.mark.sweep(every=4)
def test_a_refusal_is_one_line_whatever_it_quotes(
    place: Path, text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with answering(place / "control.sock", {"ok": False, "message": text, "exit_code": 4}):
        assert main(["arm", "--runtime-dir", str(place)]) == 4
    said = capsys.readouterr()
    assert said.out == ""
    assert_harmless(said.err, 1)
    assert said.err.startswith("aff-runtime: Eu")


# --- the house rule -------------------------------------------------------------------------

TERMINAL = "cli/terminal.py"
WRITES_OF_ITS_OWN = {"config/reference.py"}  # a tool for developers: says which page it wrote


WRITES = re.compile(r"print|\.write|warn|basicConfig|StreamHandler|FileHandler")
"""What a file has in its text that prints or opens a log: others are not walked."""


def _dotted(called: ast.expr) -> str:
    """Return what is called, as it is written: to unparse a tree takes ten times as long."""
    if isinstance(called, ast.Name):
        return called.id
    if isinstance(called, ast.Attribute):
        return f"{_dotted(called.value)}.{called.attr}"
    return "(...)"


def _calls(path: Path) -> Iterator[str]:
    for node in ast.walk(tree_of(path)):
        if isinstance(node, ast.Call):
            yield _dotted(node.func)


def test_only_one_module_prints_and_only_one_opens_a_log() -> None:
    package = ROOT / "aff_runtime"
    printing, logs = set(), set()
    for path in package.rglob("*.py"):
        if not WRITES.search(path.read_text(encoding="utf-8")):
            continue
        name = str(path.relative_to(package))
        for call in _calls(path):
            if call in ("print", "sys.stdout.write", "sys.stderr.write", "warnings.warn"):
                printing.add(name)
            if call.endswith(("basicConfig", "StreamHandler", "FileHandler")):
                logs.add(name)
    assert printing - WRITES_OF_ITS_OWN == {TERMINAL}
    assert logs == {"app/supervisor/service_log.py"}
