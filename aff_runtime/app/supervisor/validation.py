"""Runs the check of a site file in a short-lived process and brings back what it found."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from aff_runtime.base.errors import ConfigError


@dataclass(frozen=True, slots=True, kw_only=True)
class Verdict:
    """What the check says of one site file.

    Attributes
    ----------
    record : complete parameter record when the file is good, else None.
    findings : ``file:line:column  key: text`` per fault, or per warning of a good file.
    """

    record: dict[str, Any] | None
    findings: tuple[str, ...]


class Validation:
    """One check under way in ``python -m aff_runtime.app.check.validate``."""

    def __init__(self, site: Path) -> None:
        self._site = site
        self._output = tempfile.TemporaryFile()  # noqa: SIM115  lives as long as the process
        self._process = subprocess.Popen(
            [sys.executable, "-m", "aff_runtime.app.check.validate", str(site)],
            stdin=subprocess.DEVNULL,
            stdout=self._output,
        )

    def verdict(self, *, wait_s: float | None = 0.0) -> Verdict | None:
        """Return the verdict, or None while the check still runs after ``wait_s``."""
        try:
            self._process.wait(wait_s)
        except subprocess.TimeoutExpired:
            return None
        self._output.seek(0)
        text = self._output.read()
        self._output.close()
        try:
            said = json.loads(text)
            return Verdict(record=said["record"], findings=tuple(said["findings"]))
        except (ValueError, KeyError, TypeError):
            code = self._process.returncode
            return Verdict(
                record=None, findings=(f"{self._site}:1:1  the check itself failed (exit {code})",)
            )

    def abandon(self) -> None:
        """End a check whose result nobody wants any more."""
        self._process.kill()
        self._process.wait()
        self._output.close()


def load_record(site: Path) -> Verdict:
    """Check ``site`` and return its verdict.

    Raises
    ------
    ConfigError
        With every finding when the file is not good.
    """
    verdict = Validation(site).verdict(wait_s=None)
    if verdict is None or verdict.record is None:
        raise ConfigError("\n".join(verdict.findings if verdict else ("the check did not end",)))
    return verdict
