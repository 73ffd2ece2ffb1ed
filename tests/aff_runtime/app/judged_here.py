"""The check of a site file in this process: a process of its own takes a second of a core."""

from __future__ import annotations

import json
from pathlib import Path

from aff_runtime.app.check.result import CheckResult
from aff_runtime.app.check.validate import check_result
from aff_runtime.config.site_paths import STATE_DIRECTORY


def judged_here(site: Path, state: Path = STATE_DIRECTORY) -> CheckResult:
    """Return what the check's process answers, as ``load_parameters`` does.

    Raises
    ------
    ConfigError
        The file is not good.
    """
    found = CheckResult.from_json(json.loads(json.dumps(check_result(site, state).to_json())))
    found.checked()
    return found
