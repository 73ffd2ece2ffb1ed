"""What the commissioner's unit lets it do, and that nothing but a person starts it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from aff_hmi.account_command import INSTALLED_ACCOUNTS
from aff_hmi.main import INSTALLED_DOOR
from aff_hmi.main import build_parser as screen_parser
from aff_runtime.app.commission.link.messages import NAME as SOCKET
from aff_runtime.app.link.runtime_directory import INSTALLED
from aff_runtime.cli.main import build_parser
from aff_runtime.config.site_paths import STATE_DIRECTORY
from tests.each_case import each_case
from tests.security.installed_units import (
    DEPLOY,
    analyze,
    install,
    left_calls,
    needs_analyze,
    runnable,
    settings,
    stub_in,
    words_of,
)

UNIT = settings("aff-commission.service")
SERVICE = settings("aff-runtime.service")
DOOR = settings("aff-runtime.hmi.conf")
SCREEN = settings("aff-hmi.service")
SITE = STATE_DIRECTORY / "site" / "site.yaml"
COMPILES = "MemoryDenyWriteExecute=no\n"


@each_case(
    ("key", "words"),
    [
        ("User", SERVICE["User"][0]),
        ("Group", SERVICE["Group"][0]),
        ("SupplementaryGroups", "aff-door"),
        ("NoNewPrivileges", "yes"),
        ("CapabilityBoundingSet", ""),
        ("AmbientCapabilities", ""),
        ("ProtectSystem", "strict"),
        ("ProtectHome", "yes"),
        ("PrivateTmp", "yes"),
        ("PrivateDevices", "yes"),
        ("RestrictRealtime", "yes"),
        ("SocketBindDeny", "any"),
        ("IPAddressDeny", "any"),
        ("NoExecPaths", "/"),
        ("MemoryDenyWriteExecute", "yes"),
        ("LimitCORE", "0"),
        ("UMask", "0027"),
        ("RemoveIPC", "no"),
        ("RuntimeMaxSec", "8h"),
    ],
)
def test_what_the_commissioner_does_without_is_taken_from_it(key: str, words: str) -> None:
    assert UNIT[key] == [words]


def test_nothing_starts_it_by_itself() -> None:
    text = (DEPLOY / "aff-commission.service").read_text()
    assert "[Install]" not in text
    assert UNIT["Restart"] == ["no"]
    for path in DEPLOY.glob("*.*"):
        if path.is_file() and path.name not in ("aff-commission.service", "RUNBOOK.md"):
            for line in path.read_text().splitlines():
                ties = ("Requires", "Wants", "BindsTo", "Upholds", "PartOf", "Also", "After")
                assert not (line.partition("=")[0] in ties and "aff-commission" in line), line
    assert "systemctl start" not in (DEPLOY / "install.sh").read_text()


def test_it_writes_below_the_services_state_and_one_socket_and_cannot_find_the_screens() -> None:
    assert UNIT["StateDirectory"] == SERVICE["StateDirectory"]
    assert UNIT["ReadWritePaths"] == [f"-{INSTALLED_DOOR.parent}"]
    assert not {"RuntimeDirectory", "ConfigurationDirectory", "CacheDirectory"} & set(UNIT)
    hidden = {path.lstrip("-") for path in UNIT["InaccessiblePaths"][0].split()}
    assert f"/var/lib/{SCREEN['StateDirectory'][0]}" in hidden


def test_its_command_is_one_that_the_program_takes_and_meets_service_and_screen() -> None:
    program, *words = words_of(UNIT)
    assert program == words_of(SERVICE)[0]
    assert words.pop() == "$AFF_COMMISSION_OPTIONS"
    options = build_parser().parse_args(words)
    assert options.site == SITE
    assert options.card.is_relative_to(STATE_DIRECTORY)
    for path in (options.record_dir, options.line, options.watch):
        assert path.is_relative_to(STATE_DIRECTORY)
    assert options.accounts == INSTALLED_ACCOUNTS
    assert options.runtime_dir == INSTALLED
    assert options.dir == INSTALLED_DOOR.parent
    assert options.farthest.value == "panel"
    hand = (DEPLOY / "aff-hmi.listen.conf").read_text()
    (sockets,) = re.findall(r'(?m)^#Environment="AFF_HMI_HAND=(.*)"$', hand)
    screen = screen_parser().parse_args(sockets.split())
    assert screen.commission_socket == options.dir / SOCKET
    assert screen.hand_socket == INSTALLED_DOOR.parent / "hand.sock"


def test_the_service_takes_what_the_technicians_file_would_give_it() -> None:
    assert settings("aff-runtime.screen.conf") == {}
    text = (DEPLOY / "aff-runtime.screen.conf").read_text()
    ways = re.findall(r'(?m)^#Environment="AFF_RUN_OPTIONS=(.*)"$', text)
    (site,) = re.findall(r"(?m)^#Environment=AFF_SITE=(.*)$", text)
    _, *words = words_of(DOOR)
    assert words.pop() == "$AFF_RUN_OPTIONS"
    assert "AFF_RUN_OPTIONS=" in DOOR["Environment"]
    (own,) = [one for one in DOOR["Environment"] if one.startswith("AFF_SITE=")]
    assert f"AFF_SITE={words_of(SERVICE)[2]}" == own
    for way, place in zip(ways, (words_of(SERVICE)[2], site), strict=True):
        given = [place if word == "${AFF_SITE}" else word for word in [*words, *way.split()]]
        options = build_parser().parse_args(given)
        assert options.site == Path(place)
        assert options.hand_dir == INSTALLED_DOOR.parent
    assert (options.hand, options.wait, options.site) == ("commission", True, SITE)


@needs_analyze
def test_the_filter_leaves_jobs_that_give_way_and_takes_what_is_privileged() -> None:
    left = left_calls(UNIT)
    assert {"accept4", "epoll_wait", "execve", "setpriority", "sched_setaffinity"} <= left
    assert not left & {"ptrace", "setuid", "mount", "bpf", "reboot", "init_module"}


@needs_analyze
@pytest.mark.parametrize("words", [["verify"], ["security", "--offline=true", "--threshold=20"]])
def test_systemd_accepts_the_unit_and_it_is_exposed_no_more_than_2_0_of_10(
    words: list[str], tmp_path: Path
) -> None:
    path = runnable(tmp_path, "aff-commission.service")
    (tmp_path / "system-affview.slice").write_text((DEPLOY / "system-affview.slice").read_text())
    done = analyze(*words, str(path))
    assert done.returncode == 0, done.stdout[-300:] + done.stderr
    assert words != ["verify"] or (done.stdout, done.stderr) == ("", "")


@needs_analyze
@pytest.mark.parametrize(
    "words", [["verify"], ["security", "--offline=true", "--threshold=22"]], ids=lambda w: w[0]
)
def test_systemd_accepts_it_with_a_bus_and_the_line_model(
    words: list[str], tmp_path: Path
) -> None:
    can, plant = (DEPLOY / "aff-runtime.can.conf").read_text(), "[Service]\n" + COMPILES
    path = runnable(tmp_path, "aff-commission.service", can=can, plant=plant)
    (tmp_path / "system-affview.slice").write_text((DEPLOY / "system-affview.slice").read_text())
    done = analyze(*words, str(path))
    assert done.returncode == 0, done.stdout[-300:] + done.stderr
    assert COMPILES.strip() in (DEPLOY / "install.sh").read_text()


def test_hmi_brings_it_with_the_network_of_the_service_and_takes_it_away(tmp_path: Path) -> None:
    stub, root = stub_in(tmp_path), tmp_path / "root"
    assert install(root, "--hmi", python=stub).returncode == 0
    units = root / "etc/systemd/system"
    assert (units / "aff-commission.service").read_bytes() == (
        DEPLOY / "aff-commission.service"
    ).read_bytes()
    own = units / "aff-runtime.service.d"
    assert (units / "aff-commission.service.d/plc.conf").samefile(own / "plc.conf")
    screen = units / "aff-hmi.service.d/cpu.conf"
    ours = units / "aff-commission.service.d/cpu.conf"
    assert screen.exists() == ours.exists()
    assert not screen.exists() or screen.read_text() == ours.read_text()
    read = sorted(path.name for path in own.glob("*.conf"))
    assert read.index("hmi.conf") < read.index("screen.conf")  # what is read last holds
    (own / "screen.conf").write_text("mine")
    assert install(root, python=stub).returncode == 0
    assert (own / "screen.conf").read_text() == "mine"
    assert install(root, "--remove-hmi", python=stub).returncode == 0
    assert not [path for path in units.rglob("*") if "commission" in str(path)]
    assert not (own / "screen.conf").exists()


def test_accounts_are_read_by_screen_and_commissioner_and_keys_by_the_screen_alone() -> None:
    script = (
        f"getent() {{ return 0; }}; set -- --dry-run --hmi --python {sys.executable}; "
        f". {DEPLOY}/install.sh"
    )
    done = subprocess.run(
        ["sh", "-c", script, str(DEPLOY / "install.sh")],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    said = done.stdout.splitlines()
    assert "+ chown root:aff-door /etc/aff-hmi" in said
    assert "+ chmod 0750 /etc/aff-hmi" in said
    assert "aff-hmi" not in UNIT["SupplementaryGroups"][0].split()
    assert SCREEN["Group"] == ["aff-hmi"]
    assert not [line for line in said if "enable" in line and "aff-commission" in line]
