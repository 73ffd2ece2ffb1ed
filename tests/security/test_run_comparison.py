"""Two runs that somebody sends, compared: no number and no site file ends it in a traceback."""

import json
import math

import pytest

from aff_runtime.app.report.comparison import comparing, page
from aff_runtime.base.runs.window import run_window
from aff_runtime.cli import compare as cli_compare
from aff_runtime.cli.main import main
from tests.security.run_folder_rows import write_rows

pytestmark = pytest.mark.processes

LINE_AND_ROLL = """\
line: {name: a line}
gateway: {read: {channels: {tension_N: {scale: 0.1 N}}}, write: {corrections: {}}}
rolls: {roll: {radius_m: 0.05}}
actuators: {drive: {output: velocity_reference, limit_m_s: 0}}
"""
TURNING = ("time_s", "line_speed_m_s", "correction_drive_m_s", "tension_N")


def turning(folder, swing_N):
    """Write 20 turns of 16 rows, with a ripple of ``swing_N`` once a turn; return the folder."""
    folder.mkdir()
    rate = 2 * math.pi / 1.6
    rows = [
        f"{t!r},{0.05 * rate!r},0.001,{swing_N * math.cos(rate * t)!r}"
        for t in (0.1 * k for k in range(320))
    ]
    write_rows(folder, rows, TURNING)
    (folder / "site.yaml").write_text(LINE_AND_ROLL)
    return run_window(folder)


@pytest.mark.parametrize(("before_N", "after_N"), [(2.0, 0.0), (0.0, 2.0), (0.0, 0.0)])
def test_a_signal_without_any_ripple_a_limit_of_zero_and_no_state_are_compared(
    tmp_path, before_N, after_N
):
    """A dead gauge reads exactly 0: its ripple and its noise are nothing, not even small."""
    pair = turning(tmp_path / "a", before_N), turning(tmp_path / "b", after_N)
    found = comparing.compare(*pair)
    (row,) = found.rows
    assert row.before.amplitude == pytest.approx(before_N, abs=0.05)
    assert row.after.amplitude == pytest.approx(after_N, abs=0.05)
    assert (row.change.bound == "none") == (before_N == after_N)
    page.page(found)


def test_rolls_without_end_end_the_command_in_words(tmp_path, monkeypatch, capsys):
    """Each roll has an angle per row: a site file of 1 MB asked for 200 GB."""
    window = turning(tmp_path / "a", 2.0)
    write_rows(window.folder, [f"{0.1 * k!r},0.2,0,1" for k in range(20_000)], TURNING)
    rolls = {f"r{k}": {"radius_m": 0.05} for k in range(3000)}
    (window.folder / "site.yaml").write_text(
        LINE_AND_ROLL.replace("{roll: {radius_m: 0.05}}", json.dumps(rolls))
    )
    monkeypatch.setattr(cli_compare, "MEMORY_BYTES", 64 << 20)
    out = str(tmp_path / "out")
    assert main(["compare", str(window.folder), str(window.folder), "--out", out]) == 2
    assert "compare: takes more than 64 MB" in capsys.readouterr().err
    monkeypatch.setattr(cli_compare, "MEMORY_BYTES", 4 << 30)
    monkeypatch.setattr(cli_compare, "LONGEST_S", 0.2)
    assert main(["compare", str(window.folder), str(window.folder), "--out", out]) == 2
    assert "compare: takes more than 0.2 s" in capsys.readouterr().err
