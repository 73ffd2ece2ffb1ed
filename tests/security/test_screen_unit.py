"""What the screen's unit lets it do, and what the installer brings and takes away with it."""

from __future__ import annotations

import ipaddress
import os
import re
import selectors
import subprocess
import sys
from pathlib import Path

import pytest

from aff_hmi.listening import PORT
from aff_hmi.main import INSTALLED_DOOR
from aff_runtime.app.link.runtime_directory import check_trusted
from aff_runtime.app.supervisor.door import Door
from aff_runtime.app.supervisor.packet_listener import SCREEN_USER
from tests.doubles.virtual_clock import VirtualClock
from tests.each_case import each_case
from tests.security.installed_units import (
    DEPLOY,
    STUB,
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

SCREEN = settings("aff-hmi.service")
SERVICE = settings("aff-runtime.service")
DOOR = settings("aff-runtime.hmi.conf")
SLICE = "system-affview.slice"
OF_SCREEN = ("aff-hmi", "aff-door", "affview", "[hmi]", "aff-commission", "screen.conf")


@each_case(
    ("key", "words"),
    [
        ("User", SCREEN_USER),
        ("Group", SCREEN_USER),
        ("SupplementaryGroups", "aff-door"),
        ("NoNewPrivileges", "yes"),
        ("CapabilityBoundingSet", ""),
        ("AmbientCapabilities", ""),
        ("ProtectSystem", "strict"),
        ("ProtectHome", "yes"),
        ("PrivateTmp", "yes"),
        ("PrivateDevices", "yes"),
        ("RestrictAddressFamilies", "AF_INET AF_INET6 AF_UNIX"),
        ("RestrictRealtime", "yes"),
        ("SocketBindDeny", "any"),
        ("IPAddressDeny", "any"),
        ("NoExecPaths", "/"),
        ("MemoryDenyWriteExecute", "yes"),
        ("MemoryMax", "150M"),
        ("MemorySwapMax", "0"),
        ("CPUQuota", "50%"),
        ("LimitCORE", "0"),
        ("UMask", "0077"),
    ],
)
def test_what_the_screen_does_without_is_taken_from_it(key: str, words: str) -> None:
    assert SCREEN[key] == [words]


def test_it_has_neither_user_nor_group_of_the_service() -> None:
    said = [*SCREEN["User"], *SCREEN["Group"], *SCREEN["SupplementaryGroups"]]
    assert not {SERVICE["User"][0], SERVICE["Group"][0], "root"} & {*" ".join(said).split()}


def test_it_writes_its_own_history_alone_and_cannot_find_the_files_of_the_service() -> None:
    writable = {"ReadWritePaths", "CacheDirectory", "LogsDirectory"}
    assert not (writable | {"RuntimeDirectory", "ConfigurationDirectory"}) & set(SCREEN)
    assert SCREEN["StateDirectory"] == ["aff-hmi"] != SERVICE["StateDirectory"]
    assert SCREEN["StateDirectoryMode"] == ["0700"]
    hidden = {path.lstrip("-") for path in SCREEN["InaccessiblePaths"][0].split()}
    runtime, state, etc = (
        SERVICE[f"{kind}Directory"][0] for kind in ("Runtime", "State", "Configuration")
    )
    assert {f"/run/{runtime}", f"/var/lib/{state}", f"/etc/{etc}"} <= hidden
    assert not any(INSTALLED_DOOR.is_relative_to(path) for path in hidden)


def test_it_dies_first_and_gets_the_processor_last() -> None:
    assert int(SCREEN["OOMScoreAdjust"][0]) > int(SERVICE.get("OOMScoreAdjust", ["0"])[0])
    assert int(SCREEN["TasksMax"][0]) <= 40
    assert SCREEN["Slice"] == [SLICE]
    # a slice's parent is in its name: below system.slice it is weighed against the service
    assert SLICE.partition("-")[0] == "system"
    weight = re.search(r"(?m)^CPUWeight=(\d+)$", (DEPLOY / SLICE).read_text())
    assert weight is not None
    assert int(weight[1]) < int(SERVICE.get("CPUWeight", ["100"])[0])


@pytest.mark.parametrize(
    "name", ["aff-hmi.service", "aff-runtime.service", "aff-runtime.hmi.conf"]
)
def test_screen_and_service_do_not_need_each_other(name: str) -> None:
    other = "aff-runtime.service" if "hmi.service" in name else "aff-hmi"
    ties = ("Requires", "Requisite", "BindsTo", "PartOf", "Wants", "Upholds", "After", "Before")
    for line in (DEPLOY / name).read_text().splitlines():
        assert not (line.partition("=")[0] in ties and other in line), line


@each_case(
    ("address", "reached"),
    [("127.0.0.1", True), ("::1", True), ("192.168.7.31", False), ("10.0.0.1", False)],
)
def test_it_speaks_on_loopback_until_a_network_is_named(address: str, reached: bool) -> None:
    allowed = networks(" ".join(SCREEN["IPAddressAllow"]))
    assert any(ipaddress.ip_address(address) in network for network in allowed) is reached
    assert SCREEN["SocketBindAllow"] == [f"tcp:{PORT}"]


def test_the_technicians_file_changes_nothing_as_it_comes_and_two_lines_name_a_network() -> None:
    text = (DEPLOY / "aff-hmi.listen.conf").read_text()
    assert settings("aff-hmi.listen.conf") == {}
    keys = re.findall(r"(?m)^#(\w+)=", text)
    assert keys == ["Environment", "IPAddressAllow", "Environment"]
    assert all(f"--{option}" in text for option in ("listen", "host", "certificate"))
    assert "$AFF_HMI_OPTIONS" in SCREEN["ExecStart"][0].split()


def test_the_door_is_the_services_own_start_and_a_folder_for_one_group() -> None:
    clear, start = DOOR["ExecStart"]
    assert clear == ""
    own = SERVICE["ExecStart"][0].replace("/etc/aff-runtime/site.yaml", "${AFF_SITE}")
    assert start == f"{own} --door-dir {INSTALLED_DOOR.parent} $AFF_RUN_OPTIONS"
    (made,) = DOOR["ExecStartPre"]
    _, *words = made.split()
    assert made.startswith("+")
    assert words == [
        *("-d", "-o", SERVICE["User"][0], "-g", "aff-door", "-m", "2750"),
        str(INSTALLED_DOOR.parent),
    ]
    assert f"--door {INSTALLED_DOOR}" in SCREEN["ExecStart"][0]


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a folder to a group")
def test_a_door_in_that_folder_opens_to_its_group_and_to_nobody_else(tmp_path: Path) -> None:
    group = 60
    folder = tmp_path / "aff-door"
    command = ["install", "-d", "-o", "0", "-g", str(group), "-m", "2750", str(folder)]
    subprocess.run(command, check=True)
    selector = selectors.DefaultSelector()
    door = Door(folder, selector, VirtualClock(1), is_private=False)
    try:
        found = (folder / "door.sock").stat()
        assert (found.st_gid, found.st_mode & 0o777) == (group, 0o660)
        check_trusted(folder)
    finally:
        door.close()
        selector.close()


@needs_analyze
def test_the_filter_leaves_a_web_server_and_takes_what_starves_others() -> None:
    left = left_calls(SCREEN)
    assert {"accept4", "epoll_wait", "recvmsg", "mmap", "futex", "getrandom", "flock"} <= left
    assert not left & {"sched_setscheduler", "sched_setaffinity", "mlockall", "setpriority"}
    assert not left & {"ptrace", "setuid", "mount", "bpf", "reboot", "init_module"}


def unit(folder: Path) -> Path:
    """Return the screen's unit as it can be read here, its slice and drop-ins beside it."""
    (folder / SLICE).write_text((DEPLOY / SLICE).read_text())
    listen = (DEPLOY / "aff-hmi.listen.conf").read_text()
    return runnable(
        folder,
        "aff-hmi.service",
        listen=re.sub(r"(?m)^#(Environment|IPAddress)", r"\1", listen),
        cpu="[Service]\nCPUAffinity=0-0\n",
    )


@needs_analyze
def test_systemd_accepts_unit_slice_and_drop_ins_without_a_word(tmp_path: Path) -> None:
    done = analyze("verify", str(unit(tmp_path)), str(tmp_path / SLICE))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@needs_analyze
def test_the_unit_is_exposed_no_more_than_2_0_of_10(tmp_path: Path) -> None:
    done = analyze("security", "--offline=true", "--threshold=20", str(unit(tmp_path)))
    assert done.returncode == 0, done.stdout[-300:]


@needs_analyze
def test_systemd_accepts_the_service_with_its_door(tmp_path: Path) -> None:
    door = (DEPLOY / "aff-runtime.hmi.conf").read_text()
    done = analyze("verify", str(runnable(tmp_path, "aff-runtime.service", hmi=door)))
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


SHOWS = """
from aff_hmi.hub import Hub
from aff_hmi.listening import listening
from aff_hmi.server import config_of
from aff_hmi.watch import Watch
from aff_runtime.base.clock import MonotonicClock
from pathlib import Path
hub = Hub(Watch(Path("/nothing/door.sock"), MonotonicClock()), MonotonicClock())
config_of(listening("127.0.0.1:8480", (), None, None, None), hub, "en")
assert "aff_control_up 0.0" in hub.metrics()
"""


def test_the_screen_works_where_no_memory_is_both_written_and_run() -> None:
    without_written_and_run_memory(SHOWS)


@pytest.fixture
def stub(tmp_path: Path) -> str:
    """A Python that makes an environment of nothing."""
    return stub_in(tmp_path)


def tree(root: Path) -> dict[str, bytes]:
    """Return every file and folder below a root."""
    return {
        str(path.relative_to(root)): path.read_bytes() if path.is_file() else b""
        for path in root.rglob("*")
    }


def test_without_hmi_nothing_of_the_screen_is_brought(tmp_path: Path) -> None:
    said = install(tmp_path / "p", "--dry-run").stdout
    assert not [word for word in OF_SCREEN if word in said]


def test_a_dry_run_with_hmi_says_everything_and_touches_nothing(tmp_path: Path) -> None:
    done = install(tmp_path / "p", "--dry-run", "--hmi")
    assert done.returncode == 0, done.stderr
    for said in (
        *(
            "aff-hmi/venv",
            "locks/hmi.txt",
            "aff-hmi.service",
            SLICE,
            "aff-runtime.service.d/hmi.conf",
        ),
        *("listen.conf", "/etc/aff-hmi", "systemctl enable aff-hmi"),
    ):
        assert said in done.stdout
    assert not (tmp_path / "p").exists()


def test_users_and_groups_are_made_without_a_login_and_taken_away_again() -> None:
    script = f'getent() {{ return "$found"; }}; . {DEPLOY}/install.sh'

    def said(found: int, *options: str) -> list[str]:
        command = ["sh", "-c", f"found={found}; {script}", str(DEPLOY / "install.sh"), "--dry-run"]
        done = subprocess.run(
            [*command, "--python", sys.executable, *options],
            capture_output=True,
            text=True,
            check=True,
        )
        return done.stdout.splitlines()

    brought = said(2, "--hmi")
    assert "+ groupadd --system aff-door" in brought
    (user,) = [line for line in brought if line.startswith("+ useradd") and "aff-hmi" in line]
    assert "--groups aff-door " in user
    assert "--shell /usr/sbin/nologin" in user
    assert "--no-create-home" in user
    assert "aff-runtime" not in user
    assert not [line for line in said(0, "--hmi") if "useradd" in line or "groupadd" in line]
    gone = said(0, "--remove-hmi")
    reload = gone.index("+ systemctl daemon-reload")
    assert reload < gone.index("+ userdel aff-hmi") < gone.index("+ groupdel aff-door")
    assert gone[0] == "+ systemctl disable --now aff-hmi.service"
    assert not [line for line in gone if "userdel aff-runtime" in line]


def test_what_was_brought_is_taken_away_to_the_last_file(tmp_path: Path, stub: str) -> None:
    root = tmp_path / "root"
    assert install(root, python=stub).returncode == 0
    before = tree(root)
    assert install(root, "--hmi", python=stub).returncode == 0
    with_screen = tree(root)
    assert before.items() <= with_screen.items()
    added = set(with_screen) - set(before)
    known = ("hmi", "affview", "aff-commission", "aff-runtime.service.d/screen.conf")
    assert all(any(word in name for word in known) for name in added)
    assert (root / "etc/aff-hmi").stat().st_mode & 0o777 == 0o750
    done = install(root, "--remove-hmi", python=stub)
    assert done.returncode == 0, done.stderr
    assert tree(root) == before
    assert install(root, "--remove-hmi", python=stub).returncode == 0


def test_certificates_stay_when_the_screen_goes(tmp_path: Path, stub: str) -> None:
    root = tmp_path / "root"
    install(root, "--hmi", python=stub)
    key = root / "etc/aff-hmi/key.pem"
    key.write_text("mine")
    assert install(root, "--remove-hmi", python=stub).returncode == 0
    assert key.read_text() == "mine"


def test_an_update_brings_the_screen_along_and_keeps_the_technicians_file(
    tmp_path: Path, stub: str
) -> None:
    root = tmp_path / "root"
    install(root, "--hmi", python=stub)
    units = root / "etc/systemd/system"
    (units / "aff-hmi.service").write_text("old")
    (units / "aff-hmi.service.d/listen.conf").write_text("mine")
    assert install(root, python=stub).returncode == 0
    assert (units / "aff-hmi.service").read_bytes() == (DEPLOY / "aff-hmi.service").read_bytes()
    assert (units / "aff-hmi.service.d/listen.conf").read_text() == "mine"


def test_a_screen_that_cannot_be_installed_leaves_a_whole_service(tmp_path: Path) -> None:
    stub = stub_in(tmp_path, STUB.replace("esac", '    *"[hmi]"*) exit 1 ;;\nesac'))
    root = tmp_path / "root"
    assert install(root, "--hmi", python=stub).returncode != 0
    units = root / "etc/systemd/system"
    assert (units / "aff-runtime.service").exists()
    assert not (units / "aff-runtime.service.d/hmi.conf").exists()
    assert not (units / "aff-hmi.service").exists()


def test_it_never_runs_on_the_processor_of_the_control_process(tmp_path: Path, stub: str) -> None:
    processors = os.cpu_count() or 1
    root = tmp_path / "root"
    install(root, "--hmi", python=stub)
    path = root / "etc/systemd/system/aff-hmi.service.d/cpu.conf"
    if processors == 1:
        assert not path.exists()
    else:
        assert path.read_text() == f"[Service]\nCPUAffinity=0-{processors - 2}\n"
