"""Where the screen listens, and what it refuses."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

from aff_hmi.listening import LOOPBACK, PORT, host_and_port, listening
from aff_hmi.main import main
from aff_runtime.base.errors import ConfigError
from tests.each_case import each_case


def at(listen: str, hosts: tuple[str, ...] = (), tls: Path | None = None):
    return listening(listen, hosts, tls, tls, None)


@pytest.fixture
def pem(tmp_path: Path) -> Path:
    path = tmp_path / "x.pem"
    path.touch()
    return path


def test_loopback_is_known_by_its_names_and_no_other() -> None:
    place = at(f"127.0.0.1:{PORT}")
    assert set(place.hosts) == {f"127.0.0.1:{PORT}", f"localhost:{PORT}", f"[::1]:{PORT}"}
    assert place.urls == (f"http://127.0.0.1:{PORT}/",)
    assert place.bound_to == (("127.0.0.1", PORT),)


@pytest.mark.parametrize("address", ["0.0.0.0:8480", "192.168.7.31:8480", "[::]:8480"])
def test_an_address_of_a_network_needs_tls_and_leaves_loopback_open_beside_it(
    address: str, pem: Path
) -> None:
    with pytest.raises(ConfigError, match="needs TLS"):
        at(address)
    place = at(address, ("aff-line1",), pem)
    assert place.urls == ("https://aff-line1:8480/", "http://127.0.0.1:8480/")
    assert {"127.0.0.1:8480", "localhost:8480", "[::1]:8480", "aff-line1:8480"} <= set(place.hosts)
    assert (place.is_tls_at("192.168.7.31"), place.is_tls_at("127.0.0.1")) == (True, False)
    assert place.is_tls_at("fe80::1")
    assert not place.is_tls_at("::1")


@pytest.mark.parametrize(
    ("listen", "bound_to"),
    [
        ("0.0.0.0:8480", [("0.0.0.0", 8480)]),
        ("192.168.7.31:81", [("192.168.7.31", 81), ("127.0.0.1", 81)]),
        ("[::]:8480", [("::", 8480), ("127.0.0.1", 8480)]),
    ],
)
def test_no_address_is_listened_at_twice(
    listen: str, bound_to: list[tuple[str, int]], pem: Path
) -> None:
    assert list(at(listen, (), pem).bound_to) == bound_to


def test_what_is_printed_can_be_opened(pem: Path) -> None:
    assert at("0.0.0.0:8480", (), pem).urls == ("http://127.0.0.1:8480/",)
    assert not [name for name in at("[::]:8480", (), pem).hosts if name.startswith("[::]")]
    own = at("192.168.7.31:8480", (), pem)
    assert own.urls == ("https://192.168.7.31:8480/", "http://127.0.0.1:8480/")
    by_tls = at("127.0.0.1:8480", ("aff-line1",), pem)  # loopback itself, as it was asked for
    assert by_tls.urls == ("https://127.0.0.1:8480/",)
    assert by_tls.is_tls_at("127.0.0.1")


@pytest.mark.parametrize(
    ("listen", "host", "has_tls", "bare"),
    [
        ("192.168.7.31:443", "aff-line1", True, {"aff-line1", "192.168.7.31", *LOOPBACK}),
        ("192.168.7.31:8480", "aff-line1:443", True, {"aff-line1"}),
        ("[fe80::1]:443", "aff-line1", True, {"aff-line1", "[fe80::1]", *LOOPBACK}),
        ("127.0.0.1:80", "aff-line1", False, {"aff-line1", *LOOPBACK}),
        ("127.0.0.1:443", "aff-line1", False, set()),
        ("192.168.7.31:8480", "aff-line1", True, set()),
    ],
)
def test_a_browser_leaves_out_the_port_of_its_scheme(
    listen: str, host: str, has_tls: bool, bare: set[str], pem: Path
) -> None:
    place = at(listen, (host,), pem if has_tls else None)
    assert {name for name in place.hosts if not host_and_port(name)[1]} == bare


@each_case("listen", ["", "8480", "x:8480", "127.0.0.1:0", "127.0.0.1:99999", "a:b:c"])
def test_what_is_no_address_is_refused_with_an_example(listen: str) -> None:
    with pytest.raises(ConfigError, match=r"such as 127\.0\.0\.1:8480"):
        at(listen)


def test_half_of_tls_is_refused(pem: Path) -> None:
    with pytest.raises(ConfigError, match="both are needed"):
        listening("127.0.0.1:8480", (), pem, None, None)
    with pytest.raises(ConfigError, match="needs --certificate"):
        listening("127.0.0.1:8480", (), None, None, pem)
    with pytest.raises(ConfigError, match="no such file"):
        at("127.0.0.1:8480", tls=Path("/nothing.pem"))


def test_the_program_ends_with_2_and_says_what_to_do(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["--listen", "0.0.0.0:8480"]) == 2
    assert "listen on 127.0.0.1 and look through ssh -L" in capfd.readouterr().err


@pytest.mark.wire
def test_loopback_that_another_program_has_is_told_and_nothing_is_started(
    capfd: pytest.CaptureFixture[str], pem: Path
) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        port = other.getsockname()[1]
        files = ["--certificate", str(pem), "--private-key", str(pem)]
        assert main(["--listen", f"127.0.0.1:{port}"]) == 3
        assert main(["--listen", f"0.0.0.0:{port}", *files]) == 3
    said = capfd.readouterr().err
    for address in ("127.0.0.1", "0.0.0.0"):
        assert f"--listen: {address}:{port}: Address already in use" in said
