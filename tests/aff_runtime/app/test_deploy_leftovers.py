"""Who takes a gateway out of use finds by the runbook all that the installer put there."""

from __future__ import annotations

import re
import shutil
from fnmatch import fnmatchcase
from pathlib import Path

import pytest

from tests.aff_runtime.app.test_deploy import ROOT, install
from tests.security.installed_units import install as brought
from tests.security.installed_units import stub_in

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


WIPED, OF_NOBODY = (SECTION.partition(f"\n{k}. ")[2].partition(f"\n{k + 1}. ")[0] for k in (5, 6))
"""What holds something of the plant, and what the product put there and holds nothing of it."""


def taken_away(root: Path, names: list[str]) -> None:
    """Remove below ``root`` what a page names by its path; it names users and commands too."""
    for name in names:
        for path in root.glob(name.lstrip("/")) if name.startswith("/") else ():
            if path.is_dir() and not path.is_symlink():
                shutil.rmtree(path)
            else:
                path.unlink()


def left(root: Path) -> set[str]:
    """Return the paths of files and links below a folder."""
    return {
        str(path.relative_to(root))
        for path in root.rglob("*")
        if path.is_symlink() or not path.is_dir()
    }


# Its quick test: every file that the installer says it puts is below one that the runbook names.
@pytest.mark.long
def test_taken_away_by_the_runbook_site_files_and_records_are_left_and_then_nothing(
    tmp_path: Path,
) -> None:
    """Everything asked for, below a folder: no root, and an environment of nothing."""
    root = tmp_path / "root"
    assert brought(root, *ALL, python=stub_in(tmp_path)).returncode == 0
    records = ["var/lib/aff-runtime/runs/a/signals-1.csv.gz", "var/lib/aff-runtime/audit.jsonl"]
    for name in records:
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text("kept")
    taken_away(root, re.findall(r"`([^`]+)`", OF_NOBODY))
    stays = left(root)
    assert {
        *records,
        "etc/aff-runtime/site.yaml",
        "etc/aff-runtime/lines/film1/site.yaml",
    } <= stays
    of_the_plant = ("etc/aff-runtime/", "var/lib/aff-runtime/", "etc/aff-hmi/")
    others = {name for name in stays if not name.startswith(of_the_plant)}
    assert {Path(name).suffix for name in others} == {".conf"}  # drop-ins, the PLC's address
    assert all(re.match(r"etc/systemd/system/aff-[\w@-]+\.service\.d/", name) for name in others)
    taken_away(root, re.findall(r"`([^`]+)`", WIPED))
    assert left(root) == set()
