"""The page for purchasers names the packages of a gateway and their copyleft licences."""

from __future__ import annotations

import re
from importlib import metadata

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from releasing.commands import ROOT
from releasing.lock import LOCKS, pins

PAGE = (ROOT / "docs" / "trust.md").read_text()
ROWS = {"gateway": "every gateway", "can": "`--can`", "hmi": "`--hmi`", "records": "`--records`"}


def cells(lock: str) -> tuple[set[str], str]:
    """Return the packages of a lock's row, and what it says of their licences."""
    (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| {ROWS[lock]} |")]
    _, _, packages, licences, _ = row.split("|")
    return {canonicalize_name(name.strip()) for name in packages.split(",")}, licences


def locked(lock: str) -> set[str]:
    return {canonicalize_name(Requirement(pin).name) for pin in pins(LOCKS / f"{lock}.txt")}


@pytest.mark.parametrize("lock", ROWS)
def test_a_row_names_the_packages_that_its_lock_brings_beside_those_of_every_gateway(
    lock: str,
) -> None:
    brought = locked(lock) - (set() if lock == "gateway" else locked("gateway"))
    assert cells(lock)[0] == brought


@pytest.mark.parametrize("lock", ROWS)
def test_a_row_says_which_packages_are_under_a_licence_of_the_gpl_family(lock: str) -> None:
    packages, licences = cells(lock)
    copyleft = {name for name in packages if "GPL" in stated(name)}
    assert set(re.findall(r"([\w-]+) LGPL", licences)) == copyleft


def stated(package: str) -> str:
    """Return the licences that an installed package states; nothing of one that is not here."""
    try:
        said = metadata.metadata(package)
    except metadata.PackageNotFoundError:
        return ""
    rows = [said.get("License-Expression", ""), said.get("License", "")[:100]]
    rows += [row for row in said.get_all("Classifier", []) if row.startswith("License")]
    return " ".join(rows)
