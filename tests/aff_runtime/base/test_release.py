"""What runs says of which commit it is."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

import aff_runtime
from aff_runtime.app.check.validate import _versions
from aff_runtime.base.release import COMMIT, commit, release_text

ROOT = Path(aff_runtime.__file__).parents[1]


def test_an_archive_names_its_commit_and_a_checkout_none() -> None:
    written = "0123456789abcdef0123456789abcdef01234567"
    assert commit(written) == written
    assert release_text(written) == f"{aff_runtime.__version__} (commit {written})"
    assert commit("$Format:%H$") == "not recorded"


def test_a_record_names_the_commit_beside_the_version() -> None:
    assert _versions()["commit"] == commit()


def test_git_writes_the_commit_into_the_archive() -> None:
    command = ["git", "-C", str(ROOT), "check-attr", "export-subst", "aff_runtime/base/release.py"]
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=False)
    except FileNotFoundError:
        pytest.skip("no git")
    if done.returncode:
        pytest.skip("no checkout of git")
    assert done.stdout.strip().endswith("export-subst: set")
    assert COMMIT == "$" + "Format:%H$"  # nothing else is replaced
