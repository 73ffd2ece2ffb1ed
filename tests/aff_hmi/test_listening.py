"""Where the screen listens, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest

from aff_hmi.listening import PORT, listening
from aff_hmi.main import main
from aff_runtime.base.errors import ConfigError


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
    assert place.url == f"http://127.0.0.1:{PORT}/"


@pytest.mark.parametrize("address", ["0.0.0.0:8480", "192.168.7.31:8480", "[::]:8480"])
def test_an_address_of_a_network_needs_tls(address: str, pem: Path) -> None:
    with pytest.raises(ConfigError, match="needs TLS"):
        at(address)
    assert at(address, ("aff-line1",), pem).is_tls
    assert at(address, ("aff-line1",), pem).url == "https://aff-line1:8480/"


@pytest.mark.parametrize(
    "listen", ["", "8480", "x:8480", "127.0.0.1:0", "127.0.0.1:99999", "a:b:c"]
)
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
