"""Which site file ran when in a run: by the files it holds, else by what was noted of edits."""

import hashlib
from pathlib import Path

import pytest

from aff_runtime.base.runs import site_in_force
from aff_runtime.base.runs.site_in_force import changes_noted, in_force_within, sites_in_force
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.config.diff import diff_sites
from aff_runtime.config.loader import load_recorded_site
from aff_runtime.config.revision import site_hash_of
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE, recorded, steady

TEXT_A = SITE_FILE.read_text()
TEXT_B = TEXT_A.replace("limit_m_s: 0.05", "limit_m_s: 0.12").replace("settle_s: 6", "settle_s: 3")
TEXT_C = TEXT_A.replace("limit_m_s: 0.05", "limit_m_s: 0.02")


def hash_of(text):
    return site_hash_of(load_recorded_site(text, "site.yaml"))


A, B, C = map(hash_of, (TEXT_A, TEXT_B, TEXT_C))


def applied(time_s, site_hash):
    text = f"{'c' * 12}: site {site_hash[:12]}; unwind: no response"
    return time_s, {"name": "CONFIG_APPLIED", "text": text}


def sha256(text):
    return hashlib.sha256(text.encode()).hexdigest()


def applied_text(time_s, site_hash, text):
    """Return the event as a service notes it that says which text runs too."""
    _, row = applied(time_s, site_hash)
    return time_s, row | {"text": f"{row['text']}; text sha256 {sha256(text)[:12]}"}


def edits(time_s, old, new):
    """Return the events of an edit as the service notes them."""
    changes = diff_sites(*(load_recorded_site(text, "site.yaml") for text in (old, new)))
    author = "/etc/aff/site.yaml: root"
    return [(time_s, {"name": "EDIT", "text": said}) for said in (author, *map(str, changes))]


def texts(folder, rows):
    return [(one.from_s, one.text) for one in sites_in_force(folder, TEXT_A, A, rows)[1:]]


def test_a_later_site_file_is_the_one_in_the_folder_that_the_event_names(tmp_path: Path) -> None:
    (tmp_path / f"site-{B[:12]}.yaml").write_text(TEXT_B)
    rows = [applied(0.0, A), *edits(15.0, TEXT_A, TEXT_B), applied(15.2, B), applied(40.0, B)]
    assert texts(tmp_path, rows) == [(15.2, TEXT_B)]


def test_a_try_ends_in_what_ran_before_it(tmp_path: Path) -> None:
    (tmp_path / f"site-{B[:12]}.yaml").write_text(TEXT_B)
    rows = [applied(0.0, A), applied(15.0, B), applied(75.0, A)]
    assert texts(tmp_path, rows) == [(15.0, TEXT_B), (75.0, TEXT_A)]


FOLLOWER = "      - { roll: swrap_follower, orders: [1], settle_s: 10, amp_limit_m_s: 0.01 }\n"


ACTUATORS = "# Where corrections go in.\n"


@pytest.mark.parametrize(
    "new",
    [
        TEXT_B,
        TEXT_A.replace("amp_limit_m_s: 0.03 }", "amp_limit_m_s: 30.5 mm/s, enabled: false }"),
        TEXT_A.replace(FOLLOWER, ""),
        TEXT_A.replace(FOLLOWER, FOLLOWER + FOLLOWER.replace("orders: [1]", "orders: [2, 3]")),
        TEXT_A.replace("orders: [1, 2, 3, 4]", "orders: [1, 3]"),
        TEXT_A.replace(ACTUATORS, "  r9: { radius_m: 38.1 mm }\n\n" + ACTUATORS),
    ],
)
def test_a_run_without_later_files_has_the_values_that_were_noted(
    tmp_path: Path, new: str
) -> None:
    """Both ways: what came and what went; the hash of all values is that of the text that ran."""
    site = load_recorded_site(new, "site.yaml")
    assert site_hash_of(site) != A, "the text has no such place"
    rows = [applied(0.0, A), *edits(15.0, TEXT_A, new), applied(15.2, hash_of(new))]
    rows += [*edits(30.0, new, TEXT_C), applied(30.1, C)]
    found = sites_in_force(tmp_path, TEXT_A, A, rows)
    assert [hash_of(one.text) for one in found] == [A, hash_of(new), C]
    assert "from 15.2 s on another site file ran" in found[1].said


def test_an_edit_that_waits_or_is_refused_has_not_run(tmp_path: Path) -> None:
    differs = (15.1, {"name": "CONFIG_DIFFERS", "text": "line.cycle_ms: waits for bypass"})
    rows = [applied(0.0, A), *edits(15.0, TEXT_A, TEXT_B), differs]
    rows += [*edits(20.0, TEXT_A, TEXT_C), applied(20.1, C)]
    (found,) = texts(tmp_path, rows)
    assert found[0] == 20.1
    assert hash_of(found[1]) == C


def test_of_a_try_whose_text_is_nowhere_that_is_said(tmp_path: Path) -> None:
    (found,) = sites_in_force(tmp_path, TEXT_A, A, [applied(0.0, A), applied(15.0, B)])[1:]
    assert found.text == TEXT_A
    assert B[:12] in found.said
    assert "values are those of the one before" in found.said


def test_without_a_hash_of_the_beginning_the_first_one_noted_is_it(tmp_path: Path) -> None:
    rows = [applied(0.0, A), *edits(9.0, TEXT_A, TEXT_B), applied(9.0, B), applied(20.0, A)]
    found = sites_in_force(tmp_path, TEXT_A, "", rows)
    assert [(one.from_s, hash_of(one.text)) for one in found[1:]] == [(9.0, B), (20.0, A)]


def test_a_window_has_what_ran_when_it_begins_and_what_came_in_it(tmp_path: Path) -> None:
    rows = [applied(10.0, B), applied(20.0, C), applied(30.0, A)]
    for text, name in ((TEXT_B, B), (TEXT_C, C)):
        (tmp_path / f"site-{name[:12]}.yaml").write_text(text)
    sites = sites_in_force(tmp_path, TEXT_A, A, rows)
    spans = {(0.0, 5.0): [A], (12.0, 19.0): [B], (12.0, 25.0): [B, C], (31.0, 99.0): [A]}
    for span, expected in spans.items():
        assert [hash_of(one.text) for one in in_force_within(sites, *span)] == expected


def test_rows_of_a_window_come_with_the_site_file_of_their_time(tmp_path: Path) -> None:
    run = recorded(tmp_path, steady(30.0), site_text=TEXT_A)
    (run / f"site-{B[:12]}.yaml").write_text(TEXT_B)
    with (run / "events.csv").open("a") as file:
        for time_s, row in (applied(0.0, A), applied(15.0, B)):
            file.write(f'{time_s},,,{row["name"]},,"{row["text"]}"\n')
    read = {
        times: read_table(run_window(f"{run}@{times}")) for times in ("0..14", "16..30", "0..")
    }
    assert [table.site_text for table in read.values()] == [TEXT_A, TEXT_B, TEXT_A]
    assert [one.text for one in read["0.."].sites] == [TEXT_A, TEXT_B]


def test_a_site_file_of_a_run_that_was_altered_after_it_is_told(tmp_path: Path) -> None:
    """Its scale believed, compare showed other newtons; of an older run nobody can know it."""
    run = recorded(tmp_path, steady(1.0), site_text=TEXT_A)
    assert "altered" not in " ".join(read_table(run_window(str(run))).lost)
    (run / "site.yaml").write_text(TEXT_B)
    (said,) = [text for text in read_table(run_window(str(run))).lost if "altered" in text]
    assert said == (
        "site.yaml: not the text that ran, altered since: its sha256 begins with "
        f"{sha256(TEXT_B)[:12]}, expected {sha256(TEXT_A)[:12]}; scales and limits are read from "
        "it as it stands: copy it anew from the gateway"
    )
    about = (run / "run.yaml").read_text().replace("site_sha256:", "older:")
    (run / "run.yaml").write_text(about)
    assert "altered" not in " ".join(read_table(run_window(str(run))).lost)


def test_a_later_site_file_that_was_altered_after_the_run_is_told(tmp_path: Path) -> None:
    """Of two texts that say the same, the folder has either."""
    path, other = tmp_path / f"site-{B[:12]}.yaml", TEXT_B + "# the same\n"
    rows = [applied(0.0, A), applied_text(15.0, B, TEXT_B), applied_text(20.0, B, other)]
    for text, is_told in ((TEXT_B, False), (other, False), (TEXT_C, True)):
        path.write_text(text)
        later = sites_in_force(tmp_path, TEXT_A, A, rows)[1]
        assert later.said.startswith(f"{path.name}: not the text that ran") is is_told


def test_each_site_file_of_a_run_is_read_once_and_none_from_after_the_window(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A hundred tries of B, then C, of which a window before that reads nothing."""
    (tmp_path / f"site-{B[:12]}.yaml").write_text(TEXT_B)
    (tmp_path / f"site-{C[:12]}.yaml").write_text(TEXT_C)
    rows = [applied(float(k), (A, B)[k % 2]) for k in range(200)] + [applied(200.0, C)]
    read: list[str] = []
    whole = site_in_force.text_of
    monkeypatch.setattr(
        site_in_force, "text_of", lambda path, most: read.append(path.name) or whole(path, most)
    )
    found = sites_in_force(tmp_path, TEXT_A, A, rows, 199.0)
    assert [one.from_s for one in found[1:]] == [float(k) for k in range(1, 199)]
    assert {one.text for one in found[1::2]} == {TEXT_B}
    assert read == [f"site-{B[:12]}.yaml"]


def test_a_text_put_together_of_edits_is_put_together_once(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []
    whole = site_in_force.yaml_values
    monkeypatch.setattr(
        site_in_force, "yaml_values", lambda text: done.append(text) or whole(text)
    )
    there, back = edits(1.0, TEXT_A, TEXT_B), edits(2.0, TEXT_B, TEXT_A)
    rows = [applied(0.0, A)]
    for k in range(50):
        rows += [(4.0 * k + 1.0, row) for _, row in there] + [applied(4.0 * k + 2.0, B)]
        rows += [(4.0 * k + 3.0, row) for _, row in back] + [applied(4.0 * k + 4.0, A)]
    found = sites_in_force(tmp_path, TEXT_A, A, rows)
    assert len(found) == 101
    assert done.count(TEXT_A) == 1


@pytest.mark.parametrize("text", ["", "c: site ../../etc/pas; x", "c: site AAAAAAAAAAAA; x"])
def test_an_event_that_names_no_hash_is_none(tmp_path: Path, text: str) -> None:
    assert texts(tmp_path, [(1.0, {"name": "CONFIG_APPLIED", "text": text})]) == []


def test_a_note_of_the_site_file_that_ran_already_is_no_change(tmp_path: Path) -> None:
    """A recorder that follows a dead one notes what runs; nobody changed it."""
    (tmp_path / f"site-{B[:12]}.yaml").write_text(TEXT_B)
    rows = [applied(0.0, A), applied(9.0, A), applied(15.2, B), applied(40.0, B)]
    sites = sites_in_force(tmp_path, TEXT_A, A, rows)
    assert changes_noted(in_force_within(sites, 0.0, 60.0), rows) == [rows[2][1]]
    assert changes_noted(in_force_within(sites, 20.0, 60.0), rows[3:]) == []
    edit = (15.0, {"name": "EDIT", "text": "settle_s: 6 s -> 3 s (applies at once)"})
    assert changes_noted(sites, [edit]) == [edit[1]]
