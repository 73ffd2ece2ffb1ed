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
from tests.each_case import each_case

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


@each_case("lock", ROWS)
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


def settings_of(unit: str, name: str) -> list[str]:
    """Return what a unit or a drop-in of `deploy` says for one key."""
    (found,) = (ROOT / "deploy").rglob(unit)
    return re.findall(rf"^{name}=(.*)$", found.read_text(), re.MULTILINE)


@pytest.mark.parametrize(
    ("unit", "said"),
    [
        ("aff-runtime.service", "a check of the site file 1.5 GB together"),
        ("aff-hmi.service", "the screen 150 MB"),
        ("aff-commission.service", "the commissioner 1.5 GB while it runs"),
        ("aff-watch.service", "the nightly watch 2.5 GB"),
        ("aff-metrics.service", "metrics 256 MB for a moment"),
    ],
)
def test_the_memory_of_each_unit_is_that_of_the_page(unit: str, said: str) -> None:
    (row,) = [line for line in PAGE.splitlines() if line.startswith("| memory |")]
    number, letter = re.fullmatch(r"(\d+)M", settings_of(unit, "MemoryMax")[0]), "MB"
    assert number is not None
    size = int(number[1])
    if size > 1024:
        size, letter = size / 1024, "GB"
    assert said in row
    assert f"{size:g} {letter}" in said


def test_what_units_run_as_root_is_the_folder_of_the_screens_sockets_alone() -> None:
    """The page says so; `+` before a program is systemd's word for root."""
    units = [path for path in (ROOT / "deploy").rglob("aff-*") if path.is_file()]
    assert len(units) > 10
    lines = [line for path in units for line in path.read_text().splitlines()]
    as_root = {line for line in lines if re.match(r"Exec\w+=[-@:]*[+!]", line)}
    folder = "/usr/bin/install -d -o aff-runtime -g aff-door -m 2750 /run/aff-door"
    assert as_root == {f"ExecStartPre=+{folder}"}
    assert not [line for line in lines if line in ("User=root", "User=0")]
    services = [path for path in units if path.suffix == ".service"]
    assert all(settings_of(path.name, "User") for path in services)


def stated(package: str) -> str:
    """Return the licences that an installed package states; nothing of one that is not here."""
    try:
        said = metadata.metadata(package)
    except metadata.PackageNotFoundError:
        return ""
    rows = [said.get("License-Expression", ""), said.get("License", "")[:100]]
    rows += [row for row in said.get_all("Classifier", []) if row.startswith("License")]
    return " ".join(rows)
