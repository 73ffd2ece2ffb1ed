"""The page for purchasers names the packages of a gateway and their copyleft licences."""

from __future__ import annotations

import re
from importlib import metadata

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from aff_hmi.doorkeeper import PER_ACCOUNT
from aff_runtime.app.hand.accounts import LEAST_CHARACTERS, MOST_CHARACTERS, PIN_DIGITS
from aff_runtime.app.hand.audit import KEPT_FILES, MAX_BYTES
from releasing.commands import ROOT
from releasing.lock import LOCKS, pins

PAGE = (ROOT / "docs" / "trust.md").read_text()
ROWS = {"gateway": "every gateway"}
ROWS |= {extra: f"`--{extra}`" for extra in ("can", "hmi", "records", "plant")}


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


COUNTS = {5: "Five", 6: "six", 8: "eight"}


def test_bounds_of_passwords_and_of_the_audit_are_those_of_the_code() -> None:
    assert f"a password of {LEAST_CHARACTERS} to {MOST_CHARACTERS} characters" in PAGE
    assert f"a PIN of {COUNTS[PIN_DIGITS]} digits" in PAGE
    assert f"{COUNTS[PER_ACCOUNT]} tries a minute for an account from one address" in PAGE
    assert f"{KEPT_FILES * MAX_BYTES >> 20} MB, {COUNTS[KEPT_FILES]} files" in PAGE


def stated(package: str) -> str:
    """Return the licences that an installed package states; nothing of one that is not here."""
    try:
        said = metadata.metadata(package)
    except metadata.PackageNotFoundError:
        return ""
    rows = [said.get("License-Expression", ""), said.get("License", "")[:100]]
    rows += [row for row in said.get_all("Classifier", []) if row.startswith("License")]
    return " ".join(rows)
