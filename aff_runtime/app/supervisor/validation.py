"""Runs the check of a site file in a short-lived process and brings back what it found."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import IO

from aff_runtime.app.check.limits import ONE_THREAD, PATIENCE_S, TOO_LONG, TOO_SLOW
from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.supervisor.child_environment import without_service_manager
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.ports import Clock
from aff_runtime.base.python_child import module_command
from aff_runtime.config.site_paths import STATE_DIRECTORY

# More than anybody reads at once. Each is a line of the log, an event and a part of every status.
MAX_FINDINGS = 50
MAX_FINDING_LENGTH = 2000
OTHER_RELEASE = "the check is of another release than this service. Restart the service."


class Validation:
    """One check under way in ``python -m aff_runtime.app.check.validate``.

    Parameters
    ----------
    site : the site file.
    state : second folder, after the site file's own, that named files may lie in.
    clock : measures how long the check takes.
    text : checked in place of the content of the file; None: that content.
    """

    def __init__(
        self,
        site: Path,
        state: Path = STATE_DIRECTORY,
        clock: Clock | None = None,
        text: str | None = None,
    ) -> None:
        self._site = site
        self._clock = clock or MonotonicClock()
        self._end_ns = self._clock.now_ns() + int(PATIENCE_S * 1e9)
        self._output = tempfile.TemporaryFile()  # noqa: SIM115  lives as long as the process
        with _read_from(text) as given:
            self._process = subprocess.Popen(
                [
                    *module_command("aff_runtime.app.check.validate"),
                    *(str(site), str(state), *(() if text is None else ("-",))),
                ],
                stdin=given,
                stdout=self._output,
                env=without_service_manager() | ONE_THREAD,
            )

    @property
    def pid(self) -> int:
        """Process id."""
        return self._process.pid

    def result(self, *, wait_s: float = 0.0) -> CheckResult | None:
        """Return the result, or None while the check still runs after ``wait_s``.

        A check that takes longer than `PATIENCE_S` is ended, and that is the result.
        """
        try:
            self._process.wait(wait_s)
        except subprocess.TimeoutExpired:
            if self._clock.now_ns() < self._end_ns:
                return None
            self.abandon()
            return self._refused(TOO_SLOW)
        self._output.seek(0)
        text = self._output.read()
        self._output.close()
        try:
            said = json.loads(text)
        except ValueError:
            return self._refused(_how_it_died(self._process.returncode))
        try:
            checked = CheckResult.from_json(said)
        except (ValueError, KeyError, TypeError):
            return self._refused(OTHER_RELEASE)
        return replace(checked, findings=self._bounded(checked.findings))

    def abandon(self) -> None:
        """End a check whose result nobody wants any more."""
        self._process.kill()
        self._process.wait()
        self._output.close()

    def _bounded(self, findings: Sequence[str]) -> tuple[str, ...]:
        """Return as many findings as a log, a record and an answer can bear."""
        kept = [finding[:MAX_FINDING_LENGTH] for finding in findings[:MAX_FINDINGS]]
        if more := len(findings) - len(kept):
            kept.append(f"{self._site}:1:1  {more} more; `aff-runtime check` names every one")
        return tuple(kept)

    def _refused(self, why: str) -> CheckResult:
        return CheckResult(parameters=None, findings=(f"{self._site}:1:1  {why}",))


@contextlib.contextmanager
def _read_from(text: str | None) -> Iterator[IO[bytes] | int]:
    """Yield what the check reads besides files: the text, or nothing."""
    if text is None:
        yield subprocess.DEVNULL
        return
    with tempfile.TemporaryFile() as file:
        file.write(text.encode("utf-8", errors="replace"))
        file.seek(0)
        yield file


def _how_it_died(code: int) -> str:
    """Return in a sentence why a check gave no result."""
    if code == -signal.SIGXCPU:
        return TOO_LONG
    if code < 0:
        return (
            f"the check was ended by {signal.Signals(-code).name}. Somebody did that, the machine "
            "has too little memory, or a file that it names breaks its reader."
        )
    return f"the check itself failed (exit {code}); the log has its own words."


def load_parameters(
    site: Path, state: Path = STATE_DIRECTORY, text: str | None = None
) -> CheckResult:
    """Check ``site`` and return its result.

    Parameters
    ----------
    state : second folder, after the site file's own, that named files may lie in.
    text : checked in place of the content of the file; None: that content.

    Raises
    ------
    ConfigError
        With every finding when the file is not good, or when the check takes too long.
    """
    try:
        check = Validation(site, state, text=text)
    except OSError as error:
        said = error.strerror or str(error)
        raise ConfigError(
            f"{site}:1:1  cannot be checked: {said}. Free a folder for temporary files, or name "
            "one in TMPDIR."
        ) from None
    result = check.result(wait_s=PATIENCE_S)
    if result is None:
        raise ConfigError(f"{site}:1:1  {TOO_SLOW}")
    result.checked()
    return result
