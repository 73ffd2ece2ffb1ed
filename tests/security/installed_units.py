"""The systemd units of ``deploy`` as tests read them, and the installer below a folder."""

from __future__ import annotations

import ipaddress
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DEPLOY = ROOT / "deploy"
STUB = """#!/bin/sh
case "$*" in
    *"-m venv"*) for folder; do :; done; mkdir -p "$folder/bin"; cp "$0" "$folder/bin/python" ;;
    *base_prefix*) echo /usr ;;
esac
"""
"""A Python that makes an environment of nothing."""
needs_analyze = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed"
)


def settings(name: str) -> dict[str, list[str]]:
    """Return the words after each key of [Service], of all its lines together, as systemd does."""
    words_after: dict[str, list[str]] = {}
    section = (DEPLOY / name).read_text().partition("[Service]")[2].partition("\n[")[0]
    for line in section.splitlines():
        if line and not line.startswith("#"):
            key, _, words = line.partition("=")
            words_after.setdefault(key, []).append(words)
    return words_after


def words_of(unit: dict[str, list[str]]) -> list[str]:
    """Return what a unit starts, as a shell would split it."""
    return unit["ExecStart"][-1].split()


def networks(words: str) -> list[ipaddress.IPv4Network | ipaddress.IPv6Network]:
    """Return the networks that ``IPAddressAllow`` names."""
    named = {
        "localhost": ["127.0.0.0/8", "::1/128"],
        "link-local": ["169.254.0.0/16", "fe80::/64"],
    }
    return [ipaddress.ip_network(one) for word in words.split() for one in named.get(word, [word])]


def left_calls(unit: dict[str, list[str]]) -> set[str]:
    """Return every system call that the filters of a unit leave, line after line."""
    left: set[str] = set()
    for words in unit["SystemCallFilter"]:
        for word in words.lstrip("~").split():
            named = _calls(word) if word.startswith("@") else {word}
            left = left - named if words.startswith("~") else left | named
    return left


def _calls(group: str) -> set[str]:
    """Return every system call of a group of systemd."""
    done = analyze("syscall-filter", group)
    assert done.returncode == 0, done.stderr
    words = [line.split("#")[0].strip() for line in done.stdout.splitlines()[1:]]
    named = {word for word in words if word and not word.startswith("@")}
    return named.union(*(_calls(word) for word in words if word.startswith("@")))


def analyze(*words: str) -> subprocess.CompletedProcess[str]:
    """Run ``systemd-analyze``."""
    return subprocess.run(["systemd-analyze", *words], capture_output=True, text=True, check=False)


def runnable(folder: Path, name: str, **drop_ins: str) -> Path:
    """Return a unit in ``folder`` with a program that exists here, and drop-ins of these texts."""
    program = re.compile(r"/opt/\S*/bin/aff-(?:runtime|hmi)")
    path = folder / name
    path.write_text(program.sub(sys.executable, (DEPLOY / name).read_text()))
    for key, text in drop_ins.items():
        below = folder / f"{name}.d"
        below.mkdir(exist_ok=True)
        (below / f"{key}.conf").write_text(program.sub(sys.executable, text))
    return path


def without_written_and_run_memory(program: str) -> None:
    """Run a program where no memory is both written and run; fail if it fails.

    It ends with 77 where the kernel has no PR_SET_MDWE, the stand-in for MemoryDenyWriteExecute.
    """
    done = subprocess.run(
        [sys.executable, "-P", "-c", _MDWE + program], capture_output=True, text=True, check=False
    )
    if done.returncode == 77:
        pytest.skip("this kernel has no PR_SET_MDWE")
    assert done.returncode == 0, done.stderr


_MDWE = """
import ctypes, sys
if ctypes.CDLL(None, use_errno=True).prctl(65, 1, 0, 0, 0) != 0:  # PR_SET_MDWE
    sys.exit(77)
"""


def install(
    prefix: Path, *options: str, python: str = sys.executable
) -> subprocess.CompletedProcess[str]:
    """Run the installer below a prefix."""
    command = ["sh", str(DEPLOY / "install.sh"), "--prefix", str(prefix), "--python", python]
    if "--dry-run" not in options:
        command.append("--unlocked")  # a stub of Python needs no packages
    return subprocess.run([*command, *options], capture_output=True, text=True, check=False)


def stub_in(folder: Path, text: str = STUB) -> str:
    """Return the path of a stub of Python, made in ``folder``."""
    path = folder / "python"
    path.write_text(text)
    path.chmod(0o755)
    return str(path)
