import math

import pytest

from aff_runtime.base.errors import AffError
from aff_runtime.base.runs.window import names_a_run, run_window


@pytest.fixture
def run(tmp_path):
    folder = tmp_path / "a@b"
    folder.mkdir()
    (folder / "run.yaml").write_text("columns: [time_s]\n")
    return folder


@pytest.mark.parametrize(
    ("times", "expected"),
    [
        ("", (0.0, math.inf)),
        ("@12..40.5", (12.0, 40.5)),
        ("@2:00..1:02:03", (120.0, 3723.0)),
        ("@..90", (0.0, 90.0)),
        ("@90..", (90.0, math.inf)),
    ],
)
def test_times_are_seconds_minutes_or_hours_and_either_may_be_left_out(run, times, expected):
    window = run_window(f"{run}{times}")
    assert (window.folder, window.from_s, window.to_s) == (run, *expected)
    assert names_a_run(f"{run}{times}")
    assert run_window(str(window)) == window


@pytest.mark.parametrize(
    ("times", "said"),
    [
        ("@40..12", "nothing lies between 40 s and 12 s"),
        ("@1h..2h", "read '1h' for a time"),
        ("@1:75..3:00", "read '1:75' for a time; behind a colon a number is below 60"),
        ("@1:60:00..", "read '1:60:00' for a time; behind"),
    ],
)
def test_times_that_mean_nothing_are_refused_with_what_to_write(run, times, said):
    with pytest.raises(AffError, match=said):
        run_window(f"{run}{times}")


def test_a_file_and_a_folder_without_a_run_are_no_run(run, tmp_path):
    (tmp_path / "a.csv").write_text("time_s\n")
    assert not names_a_run(tmp_path / "a.csv")
    assert not names_a_run(tmp_path)
    assert not names_a_run(f"{tmp_path}@1..2")
