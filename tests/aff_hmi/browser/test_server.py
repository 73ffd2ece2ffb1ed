"""The screen as a process on a real socket: who dawdles, who floods, who listens where."""

from __future__ import annotations

import socket
import urllib.error
import urllib.request
from pathlib import Path

import pytest

from tests.processes import pause

pytestmark = [pytest.mark.browser, pytest.mark.timeout(120)]


def listening_at(port: int) -> list[str]:
    """Return the addresses at which anybody listens on a port, as the kernel writes them."""
    found = []
    for table in ("/proc/net/tcp", "/proc/net/tcp6"):
        for line in Path(table).read_text().splitlines()[1:]:
            address, state = line.split()[1], line.split()[3]
            host, _, number = address.partition(":")
            if state == "0A" and int(number, 16) == port:
                found.append(host)
    return found


def test_it_listens_on_loopback_alone(screen) -> None:
    assert listening_at(screen.port) == ["0100007F"]


def test_who_never_ends_his_request_is_let_go(screen) -> None:
    with socket.create_connection(("127.0.0.1", screen.port)) as slow:
        slow.sendall(b"GET / HTTP/1.1\r\nHost: x\r\n")
        slow.settimeout(30.0)
        assert slow.recv(100) == b""


def test_a_head_without_end_is_refused(screen) -> None:
    with socket.create_connection(("127.0.0.1", screen.port)) as babbler:
        babbler.settimeout(30.0)
        babbler.sendall(b"GET / HTTP/1.1\r\n" + b"x: " + b"y" * 20_000)
        assert babbler.recv(100).startswith(b"HTTP/1.1 400")


def test_a_flood_is_told_to_wait_and_the_screen_lives(screen) -> None:
    codes = []
    for _ in range(300):
        try:
            with urllib.request.urlopen(f"http://127.0.0.1:{screen.port}/static/icon.svg") as page:
                codes.append(page.status)
        except urllib.error.HTTPError as error:
            codes.append(error.code)
            error.close()
    assert set(codes) <= {200, 429}
    pause(2.5)
    with urllib.request.urlopen(f"http://127.0.0.1:{screen.port}/") as page:
        assert page.status == 200
        assert page.headers["server"] is None
