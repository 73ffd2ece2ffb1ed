"""What the unit lets the service do, read from the files that are installed."""

from __future__ import annotations

import ipaddress
import re
import subprocess
import sys
from pathlib import Path

import pytest

from aff_runtime.app.check.limits import MEMORY_BYTES, PATIENCE_S
from tests.each_case import each_case
from tests.security.installed_units import (
    DEPLOY,
    analyze,
    install,
    left_calls,
    needs_analyze,
    networks,
    runnable,
    settings,
    stub_in,
    without_written_and_run_memory,
)

SERVICE = settings("aff-runtime.service")


@each_case(
    ("key", "words"),
    [
        ("User", "aff-runtime"),
        ("CapabilityBoundingSet", "CAP_SYS_NICE CAP_IPC_LOCK"),
        ("NoNewPrivileges", "yes"),
        ("SocketBindDeny", "any"),
        ("IPAddressDeny", "any"),
        ("RestrictAddressFamilies", "AF_INET AF_INET6 AF_UNIX"),
        ("ProtectSystem", "strict"),
        ("ProtectHome", "yes"),
        ("PrivateTmp", "yes"),
        ("PrivateMounts", "yes"),
        ("NoExecPaths", "/"),
        ("MemoryDenyWriteExecute", "yes"),
        ("LimitCORE", "0"),
        ("OOMPolicy", "continue"),
        ("DevicePolicy", "closed"),
        ("UMask", "0027"),
    ],
)
def test_what_the_service_does_without_is_taken_from_it(key: str, words: str) -> None:
    assert SERVICE[key] == [words]


def test_programs_run_from_the_system_and_the_environment_alone() -> None:
    paths = [path.lstrip("-") for path in SERVICE["ExecPaths"][0].split()]
    (start,) = SERVICE["ExecStart"]
    assert any(start.startswith(f"{path}/") for path in paths)
    writable = ("/var", "/run", "/tmp", "/etc", "/home", "/dev")
    assert not [path for path in paths if path == "/" or path.startswith(writable)]


def test_the_memory_holds_a_service_and_one_check_and_no_more() -> None:
    unit = {"M": 1 << 20, "G": 1 << 30}
    (text,) = SERVICE["MemoryMax"]
    found = int(text[:-1]) * unit[text[-1]]
    assert MEMORY_BYTES + (500 << 20) <= found <= 2 * MEMORY_BYTES
    assert int(SERVICE["TasksMax"][0]) <= 64


def test_a_start_lasts_longer_than_the_check_may() -> None:
    assert int(SERVICE["TimeoutStartSec"][0]) > PATIENCE_S + 10


@each_case(
    ("address", "reached"),
    [
        ("127.0.0.1", True),
        ("192.168.10.20", True),
        ("10.1.2.3", True),
        ("172.16.0.1", True),
        ("172.32.0.1", False),
        ("169.254.3.4", True),
        ("fd12::5", True),
        ("8.8.8.8", False),
        ("2a00::1", False),
    ],
)
def test_the_plants_network_is_reached_and_no_other(address: str, reached: bool) -> None:
    allowed = networks(" ".join(SERVICE["IPAddressAllow"]))
    assert any(ipaddress.ip_address(address) in network for network in allowed) is reached


def test_the_technicians_file_narrows_it_to_the_plc_by_two_lines() -> None:
    text = (DEPLOY / "aff-runtime.plc.conf").read_text()
    assert "IPAddressAllow" not in settings("aff-runtime.plc.conf")  # as it comes nothing changes
    lines = re.sub(r"(?m)^#IPAddressAllow", "IPAddressAllow", text).splitlines()
    kept = [line.partition("=")[2] for line in lines if line.startswith("IPAddressAllow=")]
    assert kept[0] == ""  # takes the private networks away
    (only,) = kept[1:]
    assert [network.num_addresses for network in networks(only)] == [1 << 24, 1, 1]


def test_the_installer_brings_the_file_once_and_names_a_foreign_interpreter(
    tmp_path: Path,
) -> None:
    def dry_run() -> str:
        done = install(tmp_path, "--dry-run")
        assert done.returncode == 0, done.stderr
        return done.stdout.partition("Next:")[0]

    said = dry_run()
    assert "aff-runtime.service.d/plc.conf" in said
    if Path(sys.base_prefix).is_relative_to("/usr"):
        assert "rm -f" in said
    else:
        assert f"+ ExecPaths={sys.base_prefix} > {tmp_path}/etc/systemd" in said
    folder = tmp_path / "etc/systemd/system/aff-runtime.service.d"
    folder.mkdir(parents=True)
    (folder / "plc.conf").touch()
    assert "plc.conf" not in dry_run()


def test_can_adds_its_bus_and_devices_and_takes_nothing_away() -> None:
    added = settings("aff-runtime.can.conf")
    assert added["RestrictAddressFamilies"] == ["AF_CAN"]
    assert set(added) == {"RestrictAddressFamilies", "DeviceAllow", "SupplementaryGroups"}
    assert all(line.startswith("char-tty") for line in added["DeviceAllow"])


@needs_analyze
def test_the_filter_leaves_real_time_and_limits_and_takes_privileges() -> None:
    left = left_calls(SERVICE)
    needed = {"sched_setscheduler", "sched_setaffinity", "sched_setattr", "mlockall", "setrlimit"}
    needed |= {"prlimit64", "rt_sigprocmask", "clone", "execve", "fsync", "fchmod", "renameat2"}
    needed |= {"unlinkat", "flock", "sendmsg", "mmap", "futex", "clock_nanosleep", "memfd_create"}
    assert needed <= left
    assert not left & {
        "setuid",
        "setgroups",
        "chown",
        "chroot",
        "mount",
        "bpf",
        "ptrace",
        "capset",
    }
    assert not left & {"init_module", "kexec_load", "reboot", "swapon", "open_by_handle_at"}


COMPUTES = """
import ctypes
import aff_runtime.app.control.process, aff_runtime.telemetry.recorder, numpy
called = ctypes.CFUNCTYPE(ctypes.c_int)(lambda: 3)
assert called() == 3
assert float(numpy.linalg.solve(numpy.eye(3), numpy.ones(3)).sum()) == 3.0
"""


def test_the_service_works_where_no_memory_is_both_written_and_run() -> None:
    without_written_and_run_memory(COMPUTES)


@needs_analyze
def test_with_the_drop_ins_systemd_accepts_the_unit_without_a_word(tmp_path: Path) -> None:
    can, plc = ((DEPLOY / f"aff-runtime.{name}.conf").read_text() for name in ("can", "plc"))
    unit = runnable(tmp_path, "aff-runtime.service", can=can, plc=plc)
    done = analyze("verify", str(unit))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.parametrize("umask", ["000", "002", "077"])
def test_what_is_installed_is_read_by_the_service_and_written_by_root_alone(
    tmp_path: Path, umask: str
) -> None:
    """A shell of root's may have any umask; the folders of programs and settings had it too."""
    stub, root = stub_in(tmp_path), tmp_path / "root"
    script = (
        f"umask {umask}; exec sh {DEPLOY}/install.sh --unlocked --prefix {root} --python {stub}"
    )
    subprocess.run(["sh", "-c", script], check=True, capture_output=True)
    modes = {path: path.stat().st_mode & 0o777 for path in root.rglob("*") if path.exists()}
    assert root / "opt/aff-runtime/venv/bin" in modes
    assert [str(path) for path, mode in modes.items() if mode & 0o022 or not mode & 0o044] == []
