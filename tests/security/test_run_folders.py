"""Run folders that somebody sends: no file of one holds a command up, takes all memory or acts."""

import contextlib
import gzip
import json
import math
import os
import resource
import shutil
import signal
import time
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.report.comparison import comparing, page
from aff_runtime.app.report.comparison.site_differences import _leaves
from aff_runtime.app.report.comparison.window import load_window
from aff_runtime.base.errors import AffError
from aff_runtime.base.runs import files as run_files
from aff_runtime.base.runs import segment as run_segment
from aff_runtime.base.runs import table as run_table
from aff_runtime.base.runs.files import yaml_values
from aff_runtime.base.runs.segment import RunSegments
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import run_window
from sim_plant.refine.records import run_record
from sim_plant.refine.records.read import read_record
from sim_plant.refine.records.run_record import NEEDED
from tests.security.run_folder_rows import write_rows

pytestmark = pytest.mark.processes

ROWS = 400
COLUMNS = (*NEEDED, "tension_N")
SITE = """\
line: {name: a line}
gateway: {read: {channels: {tension_N: {scale: 0.1 N}}}, write: {corrections: {}}}
rolls: {}
actuators: {}
"""
MERGES = "a0: &a0 {x: 1}\n" + "".join(
    f"a{k}: &a{k} {{<<: [*a{k - 1}, *a{k - 1}]}}\n" for k in range(1, 30)
)
EMPTY_LISTS = "a0: &a0 []\n" + "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 4)}]\n" for k in range(1, 20)
)
TANGLED = {
    "merges": MERGES,
    "empty lists": EMPTY_LISTS,
    "itself": "a: &a {b: *a}\n",
    "deep": "[" * 30_000,
    "no month": "a: 2001-99-99\n",
    "no binary number": "a: 0b_\n",
    "many digits": f"a: {'9' * 5000}\n",
    "no stamp": "a: !!timestamp x\n",
    "no digit": 'a: !!int ""\n',
    "no truth": "a: !!bool maybe\n",
    "base 60": f"a: {':'.join(['1'] * 300)}.0\n",
}


class HeldUpError(BaseException):
    """Nothing on the way takes it for an error of a file."""


@contextlib.contextmanager
def bounded():
    """End what hangs after 10 s of its own work or 20 s of waiting, and what takes 4 GB."""

    def end(*_):
        raise HeldUpError

    before = signal.signal(signal.SIGALRM, end), signal.signal(signal.SIGVTALRM, end)
    limits = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (4 << 30, limits[1]))
    signal.setitimer(signal.ITIMER_REAL, 20.0)
    signal.setitimer(signal.ITIMER_VIRTUAL, 10.0)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
        signal.signal(signal.SIGALRM, before[0])
        signal.signal(signal.SIGVTALRM, before[1])
        resource.setrlimit(resource.RLIMIT_AS, limits)


def line_of(k, **other):
    """Return row k of a line that runs at 10 Hz."""
    row = dict.fromkeys(COLUMNS, 0.0)
    row |= {"time_s": 0.1 * k, "tick": k, "periods_count": 1, "fresh": 1, "plc_heartbeat": k}
    row |= {"status": 1 + 8, "tension_N": 90.0 + 0.1 * (k % 7)} | other
    return ",".join(str(row[name]) for name in COLUMNS)


@pytest.fixture
def run(tmp_path):
    folder = tmp_path / "run"
    folder.mkdir()
    write_rows(folder, [line_of(k) for k in range(ROWS)], COLUMNS)
    (folder / "site.yaml").write_text(SITE)
    (folder / "events.csv").write_text("time_s,name,text\n1,EDIT,a limit\n")
    (folder / "summary.json").write_text("{}")
    return folder


def test_the_run_itself_is_one_that_can_be_read(run):
    assert read_record(run).samples == ROWS
    table = read_table(run_window(run))
    assert (table.lost, len(table.events)) == ((), 1)


@pytest.mark.parametrize(
    "name", ["run.yaml", "site.yaml", "events.csv", "summary.json", "signals-0001.csv.gz"]
)
def test_a_pipe_in_the_place_of_a_file_holds_nobody_up(run, name):
    (run / name).unlink()
    os.mkfifo(run / name)
    with bounded(), contextlib.suppress(AffError):
        read_record(run)


@pytest.mark.parametrize("text", TANGLED.values(), ids=TANGLED)
def test_tangled_yaml_is_no_run_and_no_site_file(run, text):
    (run / "site.yaml").write_text(text)
    with bounded():
        with pytest.raises(AffError, match="does not say what the columns"):
            read_record(run)
        found = comparing.compare(run_window(run), run_window(run))
        assert found.rows == ()
    (run / "run.yaml").write_text(text)
    with bounded(), pytest.raises(AffError, match="not a run folder"):
        read_record(run)


def test_site_files_with_empty_aliases_are_compared_in_bounded_time(run, tmp_path):
    """No leaf ever came of them, so the bound on leaves did not end the walk."""
    other = shutil.copytree(run, tmp_path / "other")
    (other / "site.yaml").write_text(EMPTY_LISTS)
    with bounded():
        comparing.compare(run_window(run), run_window(other))


def test_a_long_key_does_not_make_every_path_long():
    paths = [path for path, _ in _leaves({"k" * 900: {"k" * 900: [1, 2]}}, "")]
    assert max(map(len, paths)) < 200


@pytest.mark.parametrize("text", ['{"rows_lost_to_disk": 1e999}', "[" * 100_000])
def test_a_summary_that_is_none_is_said(run, text):
    (run / "summary.json").write_text(text)
    assert "summary.json cannot be read" in read_table(run_window(run)).lost


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"time_s,name\n1,{'x' * 200_000}\n", "cannot be read to its end"),
        ("a\rb\rc", "cannot be read to its end"),
        (",".join(f"c{k}" for k in range(60_000)) + "\n" + "x\n" * 600, "has other columns"),
        ("time_s,name\n" + "1,x\n" * 100_001, "cannot be read to its end"),
    ],
    ids=["long cell", "other ends", "wide", "many"],
)
def test_events_that_are_too_much_are_left_out_and_said(run, text, said):
    (run / "events.csv").write_text(text)
    with bounded():
        table = read_table(run_window(run))
    assert any(said in lost for lost in table.lost)
    assert len(table.events) <= run_table.MOST_EVENTS


def test_rows_that_cannot_be_read_take_no_more_room_than_those_that_can(run):
    """A bad row had all others of its segment held as Python lists."""
    write_rows(run, ["0"] * 20_000 + ["x"], ("time_s",))
    tracemalloc.start()
    try:
        table = read_table(run_window(run))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert table.columns["time_s"].size == 20_000
    assert peak < 80 * 20_000


def test_a_segment_with_too_many_rows_is_refused_before_they_are_numbers(run, monkeypatch):
    monkeypatch.setattr(run_segment, "LARGEST_VALUES", 1000)
    monkeypatch.setattr(run_segment, "_parsed", lambda *_: pytest.fail("made numbers of them"))
    write_rows(run, ["0"] * 1001, ("time_s",))
    with pytest.raises(AffError, match="too much to be read at once"):
        read_table(run_window(run))


@pytest.mark.parametrize(
    "column", ["time_s", "tick", "periods_count", "plc_heartbeat", "tension_N"]
)
@pytest.mark.parametrize("value", ["nan", "inf", "1e308"])
@pytest.mark.parametrize("rows", [1, ROWS])
@pytest.mark.sweep(every=4)
def test_a_number_that_is_none_never_ends_in_a_traceback(run, column, value, rows):
    bad = range(300, 300 + rows)
    write_rows(
        run, [line_of(k, **({column: value} if k in bad else {})) for k in range(ROWS)], COLUMNS
    )
    with contextlib.suppress(AffError):
        read_record(run)
    with contextlib.suppress(AffError):
        comparing.compare(run_window(run), run_window(run))


@pytest.mark.parametrize("name", ["\x1b[31m_N", "\u202e_N", "x" * 300])
def test_a_column_whose_name_does_not_print_is_no_column_of_a_run(run, name):
    (run / "run.yaml").write_text(json.dumps({"columns": ["time_s", name]}))
    with pytest.raises(AffError, match="name does not print, or is too long"):
        read_record(run)


def test_a_segment_whose_first_time_is_none_hides_no_rows(run):
    """A row without a time was taken for the end of the segment before it."""
    for number, first in ((2, "nan"), (3, "inf")):
        lines = [line_of(ROWS * (number - 1) + k) for k in range(ROWS)]
        lines[0] = line_of(0, time_s=first)
        with gzip.open(run / f"signals-{number:04}.csv.gz", "wt", compresslevel=1) as file:
            file.write("\n".join([",".join(COLUMNS), *lines, ""]))
    table = read_table(run_window(run))
    assert table.columns["time_s"].size == 3 * ROWS - 2


def test_a_segment_that_goes_on_with_zeros_is_not_read_on(run):
    """A file with a hole of any size has no size in an archive; gzip reads zeros one by one."""
    with (run / "signals-0001.csv.gz").open("r+b") as file:
        file.truncate(1 << 36)
    with bounded(), pytest.raises(AffError, match="too large to be read at once"):
        read_table(run_window(run))


def test_a_run_that_takes_long_to_read_ends_in_words(run, monkeypatch):
    monkeypatch.setattr(run_record, "READ_TIMEOUT_S", 0.2)
    monkeypatch.setattr(run_record, "read_table", lambda _: time.sleep(5.0))
    with pytest.raises(AffError, match=r"takes more than 0\.2 s to read"):
        read_record(run)


def test_many_segments_are_gone_through_once():
    """The start of the next was sought among all that follow, for each."""
    count = 30_000
    segments = RunSegments(
        numbers=tuple(range(1, count + 1)),
        paths=tuple(Path(str(k)) for k in range(count)),
        starts_s=tuple(map(float, range(count))),
    )
    with bounded():
        found = list(segments.within(count - 2.5, math.inf))
    assert [path.name for path in found] == [str(count - k) for k in (3, 2, 1)]


def test_what_is_said_of_a_run_can_be_read_by_a_person(run):
    """Each torn segment, each edit had its line on the terminal and on the page."""
    for k in range(2, 400):
        (run / f"signals-{2 * k:04}.csv.gz").write_bytes(b"")
    edits = "".join(f"{k % 30},EDIT,a limit\n" for k in range(5000))
    (run / "events.csv").write_text(f"time_s,name,text\n{edits}")
    table = read_table(run_window(run))
    assert len(table.lost) == 2 * (run_table.MOST_SAID + 1)
    assert sum(said.endswith(" more of that kind") for said in table.lost) == 2
    assert len(load_window(run_window(run)).labels) <= 3 * (run_table.MOST_SAID + 1)
    assert len(read_record(run).findings) <= 4 * (run_table.MOST_SAID + 1)


def test_a_summary_is_not_read_beyond_what_one_has(run):
    (run / "summary.json").write_text(
        '{"rows_lost_to_disk": 7, "x": [' + "[]," * 1_500_000 + "1]}"
    )
    tracemalloc.start()
    try:
        assert "summary.json cannot be read" in read_table(run_window(run)).lost
        assert tracemalloc.get_traced_memory()[1] < 48 << 20
    finally:
        tracemalloc.stop()


def test_a_link_in_the_place_of_a_file_shows_nothing_of_what_it_leads_to(run, tmp_path):
    """Somebody's run would have put values of our own files on a page that we send back."""
    own = tmp_path / "own.yaml"
    own.write_text("password: mine\n")
    other = shutil.copytree(run, tmp_path / "other")
    (other / "site.yaml").unlink()
    (other / "site.yaml").symlink_to(own)
    found = comparing.compare(run_window(run), run_window(other))
    assert "mine" not in page.page(found)
    (other / "run.yaml").unlink()
    (other / "run.yaml").symlink_to(run / "run.yaml")
    with pytest.raises(AffError, match="not a run folder"):
        read_table(run_window(other))
    (tmp_path / "latest").symlink_to(run)  # of the folder itself, by whoever names it
    assert read_table(run_window(tmp_path / "latest")).columns["time_s"].size == ROWS


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("periods_count", "1e-29"),
        ("periods_count", "1e29"),
        ("plc_heartbeat", "1e-300"),
        ("time_s", "1e-320"),
        ("tick", "1e14"),
        ("status", "1e29"),
        ("state_bits", "nan"),
    ],
)
@pytest.mark.parametrize("rows", [1, ROWS - 10])
@pytest.mark.sweep(every=3)
def test_odd_but_finite_numbers_never_end_in_a_traceback(run, column, value, rows):
    bad = range(5, 5 + rows)
    lines = [line_of(k) for k in range(ROWS)]
    for k in bad:
        shown = f"{float(value) * k!r}" if column == "time_s" else value
        lines[k] = line_of(k, **{column: shown})
    write_rows(run, lines, COLUMNS)
    with contextlib.suppress(AffError):
        read_record(run)
    with contextlib.suppress(AffError):
        comparing.compare(run_window(run), run_window(run))


@pytest.mark.parametrize(
    ("scale", "transport_ms"),
    [("1e-320 m/s", "30"), ("0.001 m/s", "1e308"), ("1e308 m/s", "1e20")],
)
def test_scales_and_delays_of_a_foreign_site_file_never_end_in_a_traceback(
    run, scale, transport_ms
):
    columns = (*COLUMNS, "correction_drive_m_s")
    write_rows(run, [f"{line_of(k)},0.001" for k in range(ROWS)], columns)
    (run / "site.yaml").write_text(
        SITE.replace("corrections: {}", f"corrections: {{drive: {{scale: {scale}}}}}").replace(
            "actuators: {}",
            "actuators: {drive: {output: velocity_reference, error: {signal: tension_N}, "
            f"drive: {{transport_ms: {transport_ms}}}}}}}",
        )
    )
    with bounded():
        try:
            found = read_record(run)
        except AffError:
            return
    assert np.isfinite(found.columns["correction_drive_m_s"]).all()


def test_names_of_a_site_file_neither_act_in_the_page_nor_turn_its_text(run):
    evil = "</td><script>alert(1)</script>\u202e\x1b[2J"
    rolls = {evil: {"radius_m": 0.05, "line_speed": "tension_N"}}
    (run / "site.yaml").write_text(SITE.replace("rolls: {}", f"rolls: {json.dumps(rolls)}"))
    html = page.page(comparing.compare(run_window(run), run_window(run)))
    assert "&lt;script&gt;" in html
    assert not {"\u202e", "\x1b"} & set(html)
    assert "<script" not in html


def test_a_name_that_no_folder_can_have_is_refused_in_words():
    for name in ("a" * 5000, "a" * 5000 + "@0..5", "a@" + "9" * 5000 + ":00:00.."):
        with pytest.raises(AffError):
            read_record(name)
        with pytest.raises(AffError):
            read_table(run_window(name))


def test_values_as_the_recorder_writes_them_are_taken():
    assert yaml_values("columns: [time_s]\nmeta: {start_ns: 5, x: 1.5}\n") == {
        "columns": ["time_s"],
        "meta": {"start_ns": 5, "x": 1.5},
    }
    assert run_files.yaml_values("") is None
