"""The locks cover what pyproject.toml asks for, inside its ranges, with hashes and no host."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from releasing.commands import ROOT
from releasing.lock import BUILD, EXTRAS, LOCKS, pins
from tests.each_case import each_case

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
NAMES = (*EXTRAS, BUILD)
PYTHONS = ("3.11", "3.12", "3.13")


def asked(name: str) -> list[Requirement]:
    """Return what an installation asks for."""
    if name == BUILD:
        return [Requirement(text) for text in PROJECT["build-system"]["requires"]]
    rows = list(map(Requirement, PROJECT["project"]["dependencies"]))
    for extra in EXTRAS[name]:
        rows += of_extra(extra)
    return rows


def of_extra(extra: str) -> list[Requirement]:
    """Return what an extra asks for; one that names the product takes its extras in."""
    found = []
    for row in map(Requirement, PROJECT["project"]["optional-dependencies"][extra]):
        mine = row.name == PROJECT["project"]["name"]
        found += [one for other in row.extras for one in of_extra(other)] if mine else [row]
    return found


def locked(name: str, python: str) -> dict[str, str]:
    """Return the versions that a lock gives a gateway with this Python."""
    machine = {"python_full_version": f"{python}.0", "python_version": python}
    machine |= {"sys_platform": "linux", "platform_machine": "x86_64"}
    rows = [Requirement(pin) for pin in pins(LOCKS / f"{name}.txt")]
    meant = [row for row in rows if row.marker is None or row.marker.evaluate(machine)]
    found = {canonicalize_name(row.name): str(row.specifier).removeprefix("==") for row in meant}
    assert len(found) == len(meant), "a package stands twice"
    return found


@each_case("python", PYTHONS)
@each_case("name", NAMES)
def test_a_lock_covers_every_dependency_inside_its_range(name: str, python: str) -> None:
    found = locked(name, python)
    wrong = [
        str(row)
        for row in asked(name)
        if not row.specifier.contains(found.get(canonicalize_name(row.name), "0"))
    ]
    assert wrong == [], "run: make lock"


@each_case("name", NAMES)
def test_every_pin_has_a_hash_and_no_lock_names_a_host(name: str) -> None:
    text = (LOCKS / f"{name}.txt").read_text()
    assert pins(LOCKS / f"{name}.txt")
    blocks = re.split(r"(?m)^(?=[a-z0-9])", text)[1:]
    assert [
        block for block in blocks if not re.search(r"--hash=sha256:[0-9a-f]{64}\b", block)
    ] == []
    assert "://" not in text
    assert "index" not in text.replace("indexed", "")


def test_locks_agree_where_two_are_installed_together() -> None:
    for python in PYTHONS:
        versions: dict[str, str] = {}
        for name in EXTRAS:
            for package, version in locked(name, python).items():
                assert versions.setdefault(package, version) == version, (package, name)


def test_a_worker_of_a_cluster_gets_the_line_model_and_the_site_its_builder_alone() -> None:
    cluster, docs = locked("cluster", "3.11"), locked("docs", "3.11")
    assert {"distributed", "numba", "scipy", "pyarrow", "numpy"} <= set(cluster)
    assert {"mkdocs", "mkdocs-material", "mkdocstrings-python"} <= set(docs)
    assert not {"mkdocs", "starlette"} & set(cluster)


def test_the_installer_finds_every_lock_and_no_other_is_there() -> None:
    assert {path.stem for path in LOCKS.iterdir()} == set(NAMES)
    assert Path(ROOT / "deploy/install.sh").read_text().count("deploy/locks/") >= 3
