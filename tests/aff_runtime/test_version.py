"""One version, whether installed or run from a checkout."""

from __future__ import annotations

import tomllib
from pathlib import Path

import aff_runtime
from aff_runtime.app.check.validate import _versions

ROOT = Path(aff_runtime.__file__).parents[1]


def test_a_record_names_the_version_of_the_code_that_runs() -> None:
    assert _versions()["aff-runtime"] == aff_runtime.__version__
    assert aff_runtime.__version__[0].isdigit()


def test_the_package_metadata_reads_the_same_place() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert "version" in project["project"]["dynamic"]
    attribute = project["tool"]["setuptools"]["dynamic"]["version"]["attr"]
    assert attribute == "aff_runtime.__version__"
