"""What the log hears of a full disk, from the reports of the recorder."""

from __future__ import annotations

from aff_runtime.app.supervisor.recorder_losses import RecorderLosses
from aff_runtime.telemetry.recorder_messages import RecorderReport

FULL = "[Errno 28] No space left on device"


def said(*reports: tuple[int, int]) -> list[str]:
    """Return what is said of reports, each of rows and rows lost."""
    losses = RecorderLosses()
    steps = [losses.step(RecorderReport(rows=r, rows_lost=n, error=FULL)) for r, n in reports]
    return [text for text in steps if text]


def test_a_full_disk_is_told_once_and_its_end_with_what_was_lost() -> None:
    assert said(
        (200, 0), (400, 0), (400, 200), (400, 200), (400, 400), (600, 400), (800, 400)
    ) == [
        f"the record loses rows ({FULL}); the line goes on",
        "the record goes on; 400 rows or events of it are lost",
    ]


def test_a_second_time_is_told_again() -> None:
    told = said((0, 200), (200, 200), (200, 300), (500, 300))
    assert [text.split(" (")[0].split(";")[0] for text in told] == [
        *("the record loses rows", "the record goes on"),
        *("the record loses rows", "the record goes on"),
    ]


def test_without_a_loss_nothing_is_told() -> None:
    assert said((0, 0), (200, 0), (400, 0)) == []


def test_another_recorder_counts_from_the_beginning() -> None:
    assert len(said((200, 50), (100, 0), (300, 0), (300, 20))) == 2
