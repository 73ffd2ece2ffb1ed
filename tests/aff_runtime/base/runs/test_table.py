"""Run folders as the recorder writes them, and as crashes and disks leave them."""

import gzip
import json
import shutil
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from aff_runtime.base.errors import AffError
from aff_runtime.base.files import CLOSED_TEXT
from aff_runtime.base.runs import join as run_join
from aff_runtime.base.runs import segment as run_segment
from aff_runtime.base.runs import table as run_table
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from aff_runtime.base.yaml_section import Section
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
from tests.aff_runtime.telemetry.heads import head_of
from tests.each_case import each_case

COLUMNS = ("time_s", "tick", "tension_N")
HEADER = replace(head_of(RunMeta(), "2026-01-02T03:04:05"), columns=COLUMNS)
STEP_S = 0.01


def value(k):
    return 90.0 + 0.001 * k


@pytest.fixture
def run(tmp_path):
    """300 rows in three segments of a second, and an event in each."""
    folder = RunFolder(tmp_path, HEADER, RunContext(site_text="line: {}\n", segment_s=1.0))
    rows = [(k * STEP_S, float(k), value(k)) for k in range(300)]
    for k in range(0, 300, 25):
        folder.add(rows[k : k + 25])
        if k % 100 == 50:
            folder.add_note("EDIT", f"edit {k}")
    folder.finish(ring_overruns=0)
    return folder.path


def read(run, times="", **more):
    return read_table(run_window(f"{run}{times}"), **more)


def test_segments_are_joined_to_the_rows_that_were_recorded(run):
    table = read(run)
    assert table.columns["tick"].tolist() == list(range(300))
    assert table.columns["tension_N"] == pytest.approx([value(k) for k in range(300)])
    assert table.site_text == "line: {}\n"
    assert table.lost == ()


def test_a_window_has_its_rows_and_its_events_alone(run):
    table = read(run, "@0.5..2.0")
    assert table.columns["tick"].tolist() == list(range(50, 200))
    assert [row["text"] for row in table.events] == ["edit 50", "edit 150"]


def test_only_the_columns_asked_for_are_kept(run):
    assert list(read(run, keep=lambda name: name == "tension_N").columns) == [
        "time_s",
        "tension_N",
    ]


def test_segments_outside_the_window_are_not_unpacked(run, monkeypatch):
    unpacked, unpack = [], run_segment._unpacked
    monkeypatch.setattr(run_segment, "_unpacked", lambda p: unpacked.append(p.name) or unpack(p))
    read(run, "@1.2..1.8")
    assert unpacked == ["signals-0002.csv.gz"]


def test_a_segment_that_a_crash_left_half_written_gives_its_whole_rows(run):
    last = run / "signals-0003.csv.gz"
    last.write_bytes(last.read_bytes()[:-60])
    (run / "summary.json").unlink()
    table = read(run)
    ticks = table.columns["tick"]
    assert 200 < ticks.size < 300
    assert np.array_equal(ticks, np.arange(ticks.size))
    assert "signals-0003.csv.gz: ends torn, its last row is whole" in table.lost
    assert any("no summary.json" in text for text in table.lost)


def test_a_segment_whose_checksum_is_of_other_rows_is_named_and_left_out(run):
    segment = run / "signals-0002.csv.gz"
    content = bytearray(segment.read_bytes())
    content[-8] ^= 1  # the first byte of its checksum
    segment.write_bytes(content)
    table = read(run)
    assert table.columns["tick"].tolist() == [*range(100), *range(200, 300)]
    assert table.lost == (f"signals-0002.csv.gz: {run_segment.ALTERED}",)
    assert "copy it anew" in table.lost[0]


def test_a_segment_torn_inside_a_row_loses_that_row(run):
    last = run / "signals-0003.csv.gz"
    text = gzip.decompress(last.read_bytes())
    with gzip.open(last, "wb") as file:
        file.write(text[:-4])
    assert read(run).columns["tick"].tolist() == list(range(299))


def test_rows_that_cannot_be_read_are_counted_and_left_out(run):
    segment = run / "signals-0002.csv.gz"
    lines = gzip.decompress(segment.read_bytes()).decode().splitlines()
    lines[3], lines[5] = "1.02,1", lines[5].replace(",", ",x", 1)
    segment.write_bytes(gzip.compress(("\n".join(lines) + "\n").encode()))
    table = read(run)
    assert table.columns["tick"].size == 298
    assert table.lost == ("signals-0002.csv.gz: 2 rows cannot be read; left out",)


def test_a_missing_segment_and_what_the_disk_refused_are_named(run):
    (run / "signals-0002.csv.gz").unlink()
    summary = json.loads((run / "summary.json").read_text())
    (run / "summary.json").write_text(json.dumps(summary | {"rows_lost_to_disk": 7}))
    assert read(run).lost == ("segment 2: not there", "7 rows were refused by the disk")


def test_a_segment_of_another_run_is_left_out(run):
    (run / "signals-0002.csv.gz").write_bytes(gzip.compress(b"time_s,speed_m_s\n1,2\n"))
    table = read(run)
    assert table.columns["tick"].size == 200
    assert table.lost == ("signals-0002.csv.gz: has other columns than run.yaml; left out",)


def stretched(path, by):
    """Let the rows of a segment come at another cycle, from where it begins on."""
    head, *rows = gzip.decompress(path.read_bytes()).decode().splitlines()
    begin_s = float(rows[0].partition(",")[0])
    for k, row in enumerate(rows):
        at, _, rest = row.partition(",")
        rows[k] = f"{begin_s + by * (float(at) - begin_s):.10g},{rest}"
    path.write_bytes(gzip.compress("\n".join([head, *rows, ""]).encode()))


def test_a_segment_of_another_cycle_is_named_with_both_and_left_out(run):
    stretched(run / "signals-0002.csv.gz", 0.5)
    table = read(run)
    assert table.columns["tick"].tolist() == [*range(100), *range(200, 300)]
    (said,) = table.lost
    assert said.startswith("signals-0002.csv.gz: a tick takes 5 ms in it, 10 ms in the others")


def segment_of(run, number):
    return run / f"signals-{number:04d}.csv.gz"


@pytest.mark.parametrize(("of", "to", "ticks"), [(2, 4, 300), (1, 3, 200), (3, 1, 200)])
def test_a_segment_copied_as_another_is_named_and_counted_once(run, of, to, ticks):
    shutil.copyfile(segment_of(run, of), segment_of(run, to))
    table = read(run)
    expected = [k for k in range(300) if k // 100 + 1 != to]
    assert table.columns["tick"].tolist() == expected
    assert len(expected) == ticks
    first, last = sorted((of, to))
    (said,) = [text for text in table.lost if "times" in text]
    assert said == (
        f"signals-{last:04d}.csv.gz: 100 of its 100 rows ({of - 1}.00 to {of - 1}.99 s) are of "
        f"times that signals-{first:04d}.csv.gz has: a copy, or of another run; counted once, "
        "copy it anew from the gateway"
    )


def test_rows_of_another_run_between_those_of_a_segment_are_left_out(run):
    """Their clock is 4 ms and half a segment off: no time is the same, half are recorded twice."""
    shifted(segment_of(run, 3), -0.504)
    table = read(run)
    kept = [k for k in range(300) if not 200 <= k < 250]
    assert table.columns["tick"].tolist() == kept
    (said,) = table.lost
    assert said.startswith("signals-0003.csv.gz: 50 of its 100 rows (1.50 to 1.99 s) are of times")


def test_segments_under_each_others_numbers_are_put_in_order(run):
    content = segment_of(run, 1).read_bytes()
    shutil.copyfile(segment_of(run, 2), segment_of(run, 1))
    segment_of(run, 2).write_bytes(content)
    table = read(run)
    assert table.columns["tick"].tolist() == list(range(300))
    (said,) = table.lost
    assert said == (
        "signals-0002.csv.gz: its rows are before those of signals-0001.csv.gz; put in the order "
        "of time"
    )


def test_one_row_of_a_time_far_ahead_costs_no_later_segment(run):
    shifted(segment_of(run, 1), 1e6, slice(40, 41))
    table = read(run)
    assert table.columns["tick"].tolist() == list(range(300))
    assert [text.partition(":")[0] for text in table.lost] == ["signals-0001.csv.gz"]


def shifted(path, by_s, which=slice(None)):
    """Let the rows of a segment, or some, be of a time ``by_s`` later."""
    head, *rows = gzip.decompress(path.read_bytes()).decode().splitlines()
    for k in range(len(rows))[which]:
        at, _, rest = rows[k].partition(",")
        rows[k] = f"{float(at) + by_s:.10g},{rest}"
    path.write_bytes(gzip.compress("\n".join([head, *rows, ""]).encode()))


def test_missed_ticks_make_no_other_cycle(tmp_path):
    columns = ("time_s", "tick", run_join.PERIODS)
    folder = RunFolder(tmp_path, replace(HEADER, columns=columns), RunContext(segment_s=1.0))
    every = [
        *range(100),
        *range(101, 200, 3),
        *range(200, 300),
    ]  # two of three missed in the second
    rows = [
        (k * STEP_S, float(n), float(k - b)) for n, (b, k) in enumerate(pairwise([-1, *every]))
    ]
    folder.add(rows)
    folder.finish(ring_overruns=0)
    table = read(folder.path)
    assert (table.columns["tick"].size, table.lost) == (len(every), ())


def test_a_copy_of_a_run_has_its_name_and_another_run_has_not(run, tmp_path):
    copy = shutil.copytree(run, tmp_path / "elsewhere" / "copy")
    assert read(copy).run_id == read(run).run_id == run_table.run_id(run)
    about = copy / "run.yaml"
    about.write_text(about.read_text().replace("2026-01-02", "2026-01-03"))
    assert read(copy).run_id != read(run).run_id


@each_case(
    ("by_run", "by_site", "said"),
    [("Euclid", "Film", True), ("Euclid", "Euclid", False), ("", "Film", False), ("L", "", False)],
)
def test_a_site_file_of_another_line_is_told_by_its_name(by_run, by_site, said):
    text = run_table.other_line(Section({"name": by_run}), by_site)
    assert bool(text) == said
    if said:
        assert text.startswith("its site.yaml is of line Film, its run.yaml of Euclid; put the")


def test_a_window_without_rows_says_where_there_are_some(run):
    with pytest.raises(
        AffError, match=r"holds no row; the run has rows from 0.0 s to .* s; give times"
    ):
        read(run, "@50..60")


def test_more_than_is_held_at_once_is_refused(run, monkeypatch):
    monkeypatch.setattr(run_table, "LARGEST_VALUES", 500)
    with pytest.raises(AffError, match="give a shorter window"):
        read(run)


@pytest.mark.parametrize(
    "text", ["", "columns: 3", "columns: [tick]", "columns: [time_s, a, a]", "{", "- 1"]
)
def test_a_folder_that_is_no_run_is_refused(run, text):
    (run / "run.yaml").write_text(text)
    with pytest.raises(AffError, match="not a run folder"):
        read(run)


def test_a_run_yaml_that_was_cut_off_is_told_from_one_that_is_not_there(run):
    about = run / "run.yaml"
    about.write_text(about.read_text().partition("columns:")[0])
    with pytest.raises(AffError, match=r"its run\.yaml says no columns: cut off\? copy it anew"):
        read(run)


def test_what_was_meant_is_said_of_a_folder_that_is_no_run(run):
    (run.parent / "empty").mkdir()
    for name, said in (
        ("nowhere", "it is not there"),
        (".", "a folder of runs, name one of them, such as "),
        (f"{run.name}@20", r"times of a run are written RUN_DIR@FROM\.\.TO"),
        ("empty", "it has no run.yaml"),
    ):
        with pytest.raises(AffError, match=said):
            read_table(run_window(run.parent / name))


def test_a_run_without_any_segment_is_refused(run):
    for segment in run.glob("signals-*"):
        segment.unlink()
    with pytest.raises(AffError, match="holds no row; no segment of the run holds a row"):
        read(run)


@pytest.mark.parametrize(
    ("back_s", "said"),
    [
        (
            0.8,
            (
                "signals-0002.csv.gz: its clock goes back, from 1.49 s to 0.70 s",
                "signals-0002.csv.gz: 30 of its 100 rows (0.70 to 0.99 s) are of times that "
                "signals-0001.csv.gz has: a copy, or of another run; counted once, copy it anew "
                "from the gateway",
            ),
        ),
        (
            50.0,
            (
                "signals-0002.csv.gz: 50 rows are of a time before 0 s; left out",
                "signals-0002.csv.gz: its clock goes back, from 1.49 s to -48.50 s",
            ),
        ),
    ],
)
def test_a_clock_that_goes_back_is_named_with_what_is_left_out(run, back_s, said):
    segment = run / "signals-0002.csv.gz"
    head, *rows = gzip.decompress(segment.read_bytes()).decode().splitlines()
    times = [float(row.partition(",")[0]) - back_s * (k >= 50) for k, row in enumerate(rows)]
    rows = [f"{at:.10g},{row.partition(',')[2]}" for at, row in zip(times, rows, strict=True)]
    segment.write_bytes(gzip.compress("\n".join([head, *rows, ""]).encode()))
    assert read(run).lost == said


def test_a_run_without_its_events_says_what_is_not_known_for_that(run):
    (run / "events.csv").unlink()
    table = read(run)
    assert table.events == ()
    assert table.lost == ("no events.csv: what was armed, edited or alarmed then is not known",)


def test_a_segment_that_may_not_be_read_is_told_from_one_without_rows(run, monkeypatch):
    monkeypatch.setattr(run_segment, "is_closed", lambda path: "0002" in path.name)
    table = read(run)
    assert table.columns["tick"].size == 200
    assert table.lost == (f"signals-0002.csv.gz: {CLOSED_TEXT}",)
