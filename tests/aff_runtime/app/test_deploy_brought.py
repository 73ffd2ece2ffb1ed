"""What the installer was once told to bring it brings again; what failed it begins anew."""

from __future__ import annotations

from pathlib import Path

import pytest

from tests.security.installed_units import DEPLOY, STUB, install, stub_in

UNITS = "etc/systemd/system"
WITHOUT_PIP = STUB.replace('case "$*" in', 'case "$*" in\n    *"-m pip"*) exit 1 ;;')
FAILS = STUB.replace('cp "$0" "$folder/bin/python"', 'cp "$0" "$folder/bin/python"; exit 1')
"""As Debian's Python without python3-venv: it ends with 1, an interpreter without pip stays."""


def locks_of(said: str) -> list[str]:
    """Return the locks that a dry run takes packages of, for the service's environment."""
    rows = [line for line in said.splitlines() if "gateway.txt" in line]
    (row,) = [line for line in rows if "hmi.txt" not in line]
    return [Path(word).stem for word in row.split() if word.endswith(".txt")]


def test_an_update_brings_every_extra_again_that_was_asked_for_once(tmp_path: Path) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    options = ("--can", "--records", "--hmi", "--plant")
    assert install(root, *options, python=stub).returncode == 0
    for more in ((), ("--fresh",)):
        done = install(root, "--dry-run", *more, python=stub)
        assert locks_of(done.stdout) == ["gateway", "can", "records", "plant"], done.stderr


def test_an_update_brings_no_extra_that_nobody_asked_for(tmp_path: Path) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    assert install(root, "--hmi", python=stub).returncode == 0
    assert locks_of(install(root, "--dry-run", python=stub).stdout) == ["gateway"]


def test_an_update_without_the_option_brings_the_drop_in_of_can_up_to_date(tmp_path: Path) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    assert install(root, "--can", "--line", "film", python=stub).returncode == 0
    found = [root / UNITS / f"aff-runtime{at}.service.d/can.conf" for at in ("", "@")]
    for path in found:
        path.write_text("of a release before")
    assert install(root, python=stub).returncode == 0
    shipped = (DEPLOY / "aff-runtime.can.conf").read_text()
    assert [path.read_text() for path in found] == [shipped, shipped]


def test_the_commissioner_hears_the_bus_that_the_service_hears(tmp_path: Path) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    assert install(root, "--can", "--hmi", python=stub).returncode == 0
    link = root / UNITS / "aff-commission.service.d/can.conf"
    assert link.samefile(root / UNITS / "aff-runtime.service.d/can.conf")
    assert "RestrictAddressFamilies=AF_CAN" in link.read_text()
    assert install(root, "--remove-hmi", python=stub).returncode == 0
    assert not link.parent.exists()
    assert (root / UNITS / "aff-runtime.service.d/can.conf").exists()


def test_a_screen_that_comes_later_has_the_bus_too(tmp_path: Path) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    assert install(root, "--can", python=stub).returncode == 0
    assert install(root, "--hmi", python=stub).returncode == 0
    assert (root / UNITS / "aff-commission.service.d/can.conf").exists()


def test_plant_lets_the_commissioner_alone_compile_and_goes_with_it(tmp_path: Path) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    refused = install(root, "--plant", python=stub)
    assert refused.returncode == 2
    assert "--plant is for the commissioner, which comes with --hmi" in refused.stderr
    assert not root.exists()
    assert install(root, "--hmi", "--plant", python=stub).returncode == 0
    allowed = [p for p in root.rglob("*.conf") if "MemoryDenyWriteExecute=no" in p.read_text()]
    assert allowed == [root / UNITS / "aff-commission.service.d/plant.conf"]
    assert install(root, "--remove-hmi", python=stub).returncode == 0
    assert locks_of(install(root, "--dry-run", python=stub).stdout) == ["gateway"]


@pytest.mark.parametrize("text", [WITHOUT_PIP, FAILS], ids=["without pip", "fails"])
def test_a_python_that_makes_no_whole_environment_leaves_none_and_the_next_try_works(
    text: str, tmp_path: Path
) -> None:
    root = tmp_path / "root"
    done = install(root, python=stub_in(tmp_path, text))
    assert done.returncode == 1
    assert "apt-get install python3-venv" in done.stderr
    assert not (root / "opt/aff-runtime/venv").exists()
    assert install(root, python=stub_in(tmp_path)).returncode == 0  # the package is there now


def test_an_environment_that_a_failed_installation_left_is_made_anew(tmp_path: Path) -> None:
    left = tmp_path / "root/opt/aff-runtime/venv/bin/python"
    left.parent.mkdir(parents=True)
    left.write_text("#!/bin/sh\necho 'No module named pip' >&2; exit 1\n")
    left.chmod(0o755)
    done = install(tmp_path / "root", python=stub_in(tmp_path))
    assert done.returncode == 0, done.stderr
    assert left.read_text() == STUB
