"""The check of a site file in this process: a process of its own takes a second of a core."""

from __future__ import annotations

import json
from pathlib import Path

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.check.validate import check_result
from aff_runtime.config.site_paths import STATE_DIRECTORY


def judged_here(site: Path, state: Path = STATE_DIRECTORY, text: str | None = None) -> CheckResult:
    """Return what the check's process answers, as ``load_parameters`` does.

    Raises
    ------
    ConfigError
        The file is not good.
    """
    given = None if text is None else text.encode("utf-8")
    said = json.dumps(check_result(site, state, given).to_json())
    found = CheckResult.from_json(json.loads(said))
    found.checked()
    return found
