"""How long the records last is told by `check`, and is what segments of a run really take."""

from __future__ import annotations

import gzip
from pathlib import Path

import pytest

from aff_runtime.app.check.record_size import BYTES_PER_VALUE, record_line, record_width
from aff_runtime.cli.main import main
from aff_runtime.config.loader import load_site
from tests.doubles.recorded_run import RecordedRun, files
from tests.lockstep.known_response import ROOT

EUCLID = ROOT / "config" / "euclid.yaml"


def test_check_says_how_long_the_records_last(capsys: pytest.CaptureFixture[str]) -> None:
    """174 columns of 2.8 bytes, 200 a second: 97 kB/s; 500 MB last 5131 s, a day is 8419 MB."""
    assert main(["check", str(EUCLID)]) == 0
    (row,) = [line for line in capsys.readouterr().out.splitlines() if line.startswith("record:")]
    assert row == (
        "record: 500 MB (recording.max_MB) hold 1.4 h of a running correction "
        "(174 columns at 5 ms); a day takes 8400 MB"
    )
    assert main(["check", str(EUCLID), "--brief"]) == 0
    assert "record:" not in capsys.readouterr().out


def test_a_faster_cycle_and_a_larger_disk_change_it_in_proportion() -> None:
    site = load_site(EUCLID)
    line = site.line.model_copy(update={"cycle_ms": 1.0})
    recording = site.recording.model_copy(update={"max_MB": 5000.0})
    fast = site.model_copy(update={"line": line, "recording": recording})
    assert "5000 MB (recording.max_MB) hold 2.9 h" in record_line(fast)
    assert record_line(fast).endswith("(174 columns at 1 ms); a day takes 42000 MB")


@pytest.mark.long  # simulates 45 s; quick: the columns and the sentence above
def test_a_real_segment_has_these_columns_and_this_size(tmp_path: Path) -> None:
    made = files(tmp_path, reference=False, cancels="", site_file=EUCLID)
    run = RecordedRun(made, tmp_path / "runs", law_too=True)
    run.bench.run(3.0)
    run.bench.arm(42.0)
    segments = sorted(run.end().glob("signals-*.csv.gz"))[:2]
    width = record_width(load_site(made.site))
    for segment in segments:
        head, *rows = gzip.decompress(segment.read_bytes()).decode().splitlines()
        assert len(head.split(",")) == width
        assert segment.stat().st_size / len(rows) == pytest.approx(
            BYTES_PER_VALUE * width, rel=0.1
        )
