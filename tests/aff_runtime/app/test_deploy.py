"""The unit and the installer, as far as they can be tried without systemd running."""

from __future__ import annotations

import re
import shlex
import shutil
import ssl
import stat
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
UNIT = ROOT / "deploy" / "aff-runtime.service"
needs_analyze = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed"
)


@pytest.fixture
def unit(tmp_path: Path) -> Path:
    """The unit with a program that exists here."""
    text = re.sub(r"/opt/\S*/bin/aff-runtime", sys.executable, UNIT.read_text())
    path = tmp_path / "aff-runtime.service"
    path.write_text(text)
    return path


@needs_analyze
def test_systemd_accepts_the_unit_without_a_word(unit: Path) -> None:
    done = subprocess.run(
        ["systemd-analyze", "verify", str(unit)], capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@needs_analyze
def test_the_unit_is_exposed_no_more_than_2_0_of_10(unit: Path) -> None:
    command = ["systemd-analyze", "security", "--offline=true", "--threshold=20", str(unit)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout[-300:]


def test_the_unit_lets_the_control_process_feed_the_watchdog_and_ask_for_rights() -> None:
    lines = UNIT.read_text().splitlines()
    for needed in (
        "NotifyAccess=all",
        "LimitRTPRIO=80",
        "RestrictRealtime=no",
        "DeviceAllow=/dev/cpu_dma_latency rw",
        "SystemCallFilter=@system-service @resources",
    ):
        assert needed in lines
    assert not any(line.startswith("CPUSchedulingPolicy=") for line in lines)


def install(*options: str) -> subprocess.CompletedProcess[str]:
    command = ["sh", str(ROOT / "deploy" / "install.sh"), "--python", sys.executable, *options]
    return subprocess.run(command, capture_output=True, text=True, check=False)


def test_a_dry_run_says_everything_and_touches_nothing(tmp_path: Path) -> None:
    done = install("--dry-run", "--prefix", str(tmp_path / "p"))
    assert done.returncode == 0, done.stderr
    for said in ("-m venv", "pip install", "aff-runtime.service", "site.yaml", "learned"):
        assert said in done.stdout
    assert not (tmp_path / "p").exists()


def packages_of(done: subprocess.CompletedProcess[str]) -> list[str]:
    """Return the locks by which a dry run would take packages, in order."""
    rows = [line for line in done.stdout.splitlines() if "--require-hashes" in line]
    return [Path(word).name for row in rows for word in row.split() if word.endswith(".txt")]


def test_the_installer_asks_for_no_extras(tmp_path: Path) -> None:
    done = install("--dry-run", "--prefix", str(tmp_path / "p"))
    assert packages_of(done) == ["build.txt", "gateway.txt"]
    done = install("--dry-run", "--unlocked", "--prefix", str(tmp_path / "p"))
    (pip,) = [line for line in done.stdout.splitlines() if "pip install" in line]
    assert pip.endswith(str(ROOT))


def test_every_package_is_compared_with_its_hash_and_none_is_built(tmp_path: Path) -> None:
    done = install("--dry-run", "--can", "--records", "--hmi", "--prefix", str(tmp_path / "p"))
    expected = ["build.txt", "gateway.txt", "can.txt", "records.txt", "gateway.txt", "hmi.txt"]
    assert packages_of(done) == expected
    for row in [line for line in done.stdout.splitlines() if " -m pip " in line]:
        assert "--only-binary :all: --require-hashes" in row or "--no-index" in row


def test_without_a_network_packages_come_from_a_folder_alone(tmp_path: Path) -> None:
    folder = tmp_path / "my wheels"
    done = install("--dry-run", "--wheels", str(folder), "--prefix", str(tmp_path / "p"))
    rows = [line for line in done.stdout.splitlines() if " -m pip " in line]
    assert len(rows) == 4
    assert [row for row in rows if "--no-index" not in row] == []
    assert [row for row in rows if f"--find-links {folder}" in row] == [rows[0], rows[2]]
    assert install("--dry-run", "--wheels", str(folder), "--unlocked").returncode == 2


def product_of(path: Path, text: bytes) -> Path:
    """Write a wheel that says this of its commit."""
    with zipfile.ZipFile(path, "w") as made:
        made.writestr("aff_runtime/base/release.py", text)
    return path


def test_a_wheel_of_the_same_release_is_installed_instead_of_built(tmp_path: Path) -> None:
    ours = (ROOT / "aff_runtime" / "base" / "release.py").read_bytes()
    wheel = product_of(tmp_path / "aff_runtime-0-cp311-abi3-linux_x86_64.whl", ours)
    done = install("--dry-run", "--product", str(wheel), "--prefix", str(tmp_path / "p"))
    rows = [line for line in done.stdout.splitlines() if " -m pip " in line]
    assert packages_of(done) == ["gateway.txt"]
    assert rows[-1].endswith(f"--force-reinstall {wheel}")
    assert not any("pip wheel" in row for row in rows)


def test_a_wheel_of_another_commit_is_refused(tmp_path: Path) -> None:
    wheel = product_of(tmp_path / "other.whl", b'COMMIT = "1234"')
    done = install("--dry-run", "--product", str(wheel), "--prefix", str(tmp_path / "p"))
    assert done.returncode == 2
    assert "no wheel of the commit" in done.stderr
    assert "pip" not in done.stdout
    ours = (ROOT / "aff_runtime" / "base" / "release.py").read_bytes()
    wheel = product_of(tmp_path / "same.whl", ours)
    assert install("--dry-run", "--product", str(wheel), "--unlocked").returncode == 2


def test_a_second_installation_keeps_the_technicians_files(tmp_path: Path) -> None:
    site = tmp_path / "p" / "etc" / "aff-runtime" / "site.yaml"
    site.parent.mkdir(parents=True)
    site.write_text("mine")
    done = install("--dry-run", "--prefix", str(tmp_path / "p"))
    assert "euclid.yaml" not in done.stdout
    assert "plc.conf" in done.stdout
    (tmp_path / "p/etc/systemd/system/aff-runtime.service.d").mkdir(parents=True)
    (tmp_path / "p/etc/systemd/system/aff-runtime.service.d/plc.conf").write_text("mine")
    done = install("--dry-run", "--prefix", str(tmp_path / "p"))
    assert "plc.conf" not in done.stdout.partition("Next:")[0]


def test_an_unknown_option_is_refused() -> None:
    assert install("--purge").returncode == 2


def test_can_brings_its_packages_and_the_right_to_use_the_bus(tmp_path: Path) -> None:
    done = install("--dry-run", "--can", "--prefix", str(tmp_path / "p"))
    assert packages_of(done)[-1] == "can.txt"
    unlocked = install("--dry-run", "--can", "--unlocked", "--prefix", str(tmp_path / "p"))
    assert f"{ROOT}[can]" in unlocked.stdout
    assert "aff-runtime.service.d/can.conf" in done.stdout
    assert "RestrictAddressFamilies=AF_CAN" in (ROOT / "deploy/aff-runtime.can.conf").read_text()


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl is needed")
def test_the_screen_gets_an_elliptic_key_that_only_its_group_reads(tmp_path: Path) -> None:
    """The commands that a dry run tells, run in a folder of the test."""
    prefix = tmp_path / "p"
    told = install("--dry-run", "--hmi", "--prefix", str(prefix)).stdout.splitlines()
    of_key = [row.removeprefix("+ ") for row in told if "/etc/aff-hmi" in row]
    assert [shlex.split(row)[0] for row in of_key][:3] == ["mkdir", "chmod", "openssl"]
    for row in of_key:
        subprocess.run(shlex.split(row), check=True, capture_output=True)
    key, certificate = prefix / "etc/aff-hmi/key.pem", prefix / "etc/aff-hmi/cert.pem"
    assert stat.S_IMODE(key.stat().st_mode) == 0o640
    show = ["openssl", "pkey", "-noout", "-text", "-in", str(key)]
    said = subprocess.run(show, check=True, capture_output=True, text=True).stdout
    assert "NIST CURVE: P-256" in said
    served = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    served.load_cert_chain(certificate, key)  # they belong together
    again = install("--dry-run", "--hmi", "--prefix", str(prefix)).stdout
    assert "openssl req" not in again
    assert "ingerprint=" in again


def test_a_certificate_of_the_plants_own_stays(tmp_path: Path) -> None:
    there = tmp_path / "p/etc/aff-hmi"
    there.mkdir(parents=True)
    (there / "cert.pem").write_text("the plant's")
    assert (
        "openssl req" not in install("--dry-run", "--hmi", "--prefix", str(tmp_path / "p")).stdout
    )
