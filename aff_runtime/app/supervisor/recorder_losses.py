"""What the log hears of a record that loses rows: when it begins, and when it is over."""

from __future__ import annotations

from aff_runtime.telemetry.recorder_messages import RecorderReport


class RecorderLosses:
    """Follows the recorder's reports; one sentence when rows are lost, one when none are again."""

    def __init__(self) -> None:
        self._rows = self._lost = 0
        self._is_losing = False

    def step(self, report: RecorderReport) -> str:
        """Return a sentence for the log, empty where nothing is new."""
        rows, lost = report.rows, report.rows_lost
        said = ""
        if lost < self._lost:  # another recorder, which counts from the beginning
            self._is_losing = False
        elif lost > self._lost and not self._is_losing:
            self._is_losing = True
            why = report.error or "the disk refuses them"
            said = f"the record loses rows ({why}); the line goes on"
        elif self._is_losing and lost == self._lost and rows > self._rows:
            self._is_losing = False
            said = f"the record goes on; {lost} rows or events of it are lost"
        self._rows, self._lost = rows, lost
        return said
