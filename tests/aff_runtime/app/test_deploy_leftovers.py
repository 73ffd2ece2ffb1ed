"""Who takes a gateway out of use finds by the runbook all that the installer put there."""

from __future__ import annotations

import re
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from tests.aff_runtime.app.test_deploy import ROOT, install

SECTION = (
    (ROOT / "deploy" / "RUNBOOK.md").read_text().partition("## Take a gateway out of use\n")[2]
)
NAMED = re.findall(r"`([^`]+)`", SECTION)
PUT = re.compile(r"(?<![\w./=@-])/(?:etc|opt|usr/local|var)/[\w./@-]+")
OF_THE_SYSTEM = {"/etc/systemd/system", "/etc/udev/rules.d"}
ALL = ["--can", "--records", "--hmi", "--plant", "--line", "film1"]


@pytest.fixture(scope="module")
def rows() -> list[str]:
    """What the installer does as root, everything asked for."""
    done = install("--dry-run", *ALL)
    assert done.returncode == 0, done.stderr
    said = [line for line in done.stdout.splitlines() if line.startswith("+ ")]
    return [line.replace(str(ROOT), "SOURCE") for line in said]


def test_every_file_that_the_installer_puts_is_below_one_that_the_runbook_names(
    rows: list[str],
) -> None:
    found = {path for row in rows for path in PUT.findall(row)} - OF_THE_SYSTEM
    assert len(found) > 40
    unnamed = [
        path
        for path in found
        for above in [[path, *map(str, Path(path).parents)]]
        if not any(fnmatchcase(one, name) for one in above for name in NAMED if name != "/")
    ]
    assert sorted(unnamed) == []


def test_every_user_and_group_that_the_installer_makes_is_named_by_the_runbook(
    rows: list[str],
) -> None:
    made = {row.split()[-1] for row in rows if row.startswith(("+ useradd", "+ groupadd"))}
    assert made == {"aff-runtime", "aff-hmi", "aff-door"}
    assert made <= set(NAMED)
