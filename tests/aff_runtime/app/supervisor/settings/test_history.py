"""The history of a site file: who, when, why, and the text itself."""

import hashlib
import json

from aff_runtime.app.supervisor.settings import history as module
from aff_runtime.app.supervisor.settings.history import ROWS, SiteHistory, history_folder


def made(folder):
    return SiteHistory(folder, now=lambda: "2026-01-02T03:04:05.000+00:00")


def test_every_version_has_who_when_why_and_its_text(tmp_path):
    first = made(tmp_path / "h")
    first.add("started", "version: 1\n", who="file of uid 0", why="")
    first.add("kept", "version: 1 # ä\n", who="uid 1000 (tech1 via root), pid 7", why="8 dB less")
    rows = made(tmp_path / "h").versions  # read anew
    assert [(row.number, row.verb) for row in rows] == [(1, "started"), (2, "kept")]
    assert rows[1].who == "uid 1000 (tech1 via root), pid 7"
    assert rows[1].when == "2026-01-02T03:04:05.000+00:00"
    assert rows[1].sha256 == hashlib.sha256("version: 1 # ä\n".encode()).hexdigest()
    assert made(tmp_path / "h").text(rows[1]) == "version: 1 # ä\n"


def test_a_text_that_was_changed_is_not_handed_out(tmp_path):
    history = made(tmp_path)
    row = history.add("kept", "a: 1\n", who="x", why="y")
    (text,) = tmp_path.glob("*.yaml")
    text.write_text("a: 2\n")
    assert history.text(row) == ""


def test_a_damaged_text_is_whole_again_when_it_runs_again(tmp_path):
    history = made(tmp_path)
    history.add("kept", "a: 1\n", who="x", why="y")
    (text,) = tmp_path.glob("*.yaml")
    text.write_text("a: ")
    assert history.text(history.add("undone", "a: 1\n", who="x", why="y")) == "a: 1\n"


def test_the_oldest_go_with_their_texts(tmp_path, monkeypatch):
    monkeypatch.setattr(module, "MOST", 3)
    history = made(tmp_path)
    for number in range(5):
        history.add("kept", f"a: {number // 2}\n", who="x", why="y")
    assert [row.number for row in made(tmp_path).versions] == [3, 4, 5]
    assert sorted(path.read_text() for path in tmp_path.glob("*.yaml")) == ["a: 1\n", "a: 2\n"]


def test_a_row_that_cannot_be_read_is_left_out_and_names_are_made_printable(tmp_path):
    history = made(tmp_path)
    history.add("kept", "a: 1\n", who="x\nINFO arm", why="\x1b[2J")
    (row,) = made(tmp_path).versions
    assert "\n" not in row.who
    assert "\x1b" not in row.why
    rows = tmp_path / ROWS
    odd = ['{"number": "x"}', "nonsense", '{"number": 1e999}', "[" * 100_000]
    rows.write_text("\n".join([*odd, rows.read_text()]))
    assert [row.number for row in made(tmp_path).versions] == [1]
    assert json.loads(rows.read_text().splitlines()[-1])["verb"] == "kept"


def test_what_cannot_be_written_disturbs_nothing(tmp_path):
    (tmp_path / "h").write_text("a file in the place of the folder")
    history = made(tmp_path / "h")
    assert history.add("kept", "a: 1\n", who="x", why="y").number == 1
    assert len(history.versions) == 1


def test_two_sites_of_one_name_have_a_history_each(tmp_path):
    (tmp_path / "state").mkdir()
    one, other = (tmp_path / name / "site.yaml" for name in ("a", "b"))
    folders = {history_folder(site, tmp_path / "state") for site in (one, other)}
    assert len(folders) == 2
    assert {folder.parent for folder in folders} == {tmp_path / "state" / "settings"}
    beside = history_folder(one, tmp_path / "no such folder")
    assert beside.parent == tmp_path / "a" / "learned" / "settings"
