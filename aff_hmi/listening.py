"""Where the screen listens: loopback always, an address of the network beside it with TLS."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass
from pathlib import Path

from aff_hmi.admission import is_near
from aff_runtime.base.errors import ConfigError

PORT = 8480
PANEL, EVERYWHERE = "127.0.0.1", "0.0.0.0"
LOOPBACK = (PANEL, "localhost", "[::1]")
HTTP_PORT, HTTPS_PORT = "80", "443"  # a browser leaves out the port that its scheme has anyway


@dataclass(frozen=True, slots=True, kw_only=True)
class Listening:
    """Address, names and TLS.

    TLS is of the network: the panel's browser comes to loopback, where nobody listens in and no
    certificate has a name, in clear as it does without a network.

    Attributes
    ----------
    hosts : ``name:port`` that a browser may call this screen by.
    client_ca : whose certificates a browser must show; None asks for none.
    """

    address: str = PANEL
    port: int = PORT
    hosts: tuple[str, ...] = ()
    certificate: Path | None = None
    private_key: Path | None = None
    client_ca: Path | None = None

    @property
    def bound_to(self) -> tuple[tuple[str, int], ...]:
        """Every address and port that is listened at; 0.0.0.0 has loopback in it."""
        beside = not is_near(self.address) and self.address != EVERYWHERE
        return ((self.address, self.port), *([(PANEL, self.port)] if beside else []))

    def is_tls_at(self, address: str) -> bool:
        """Return whether who comes to an address of this machine comes by https."""
        is_panel = is_near(address) and not is_near(self.address)
        return self.certificate is not None and not is_panel

    @property
    def urls(self) -> tuple[str, ...]:
        """What can be typed into a browser: one that knows the first name, then one here."""
        if is_near(self.address):
            scheme = "https" if self.is_tls_at(self.address) else "http"
            return (f"{scheme}://{_shown(self.address)}:{self.port}/",)
        of_network = [one for one in self.hosts if host_and_port(one)[0] not in LOOPBACK]
        return (*(f"https://{one}/" for one in of_network[:1]), f"http://{PANEL}:{self.port}/")


def listening(
    listen: str,
    hosts: tuple[str, ...],
    certificate: Path | None,
    private_key: Path | None,
    client_ca: Path | None,
) -> Listening:
    """Return where to listen.

    Parameters
    ----------
    listen : ``ADDRESS:PORT``, an address of this machine.
    hosts : further names, with or without a port.

    Raises
    ------
    ConfigError
        When the address is none, is one of a network and TLS is not set, or TLS is set by halves.
    """
    address, port = _address(listen)
    if (certificate is None) != (private_key is None):
        raise ConfigError("--certificate and --private-key: both are needed, or neither")
    if client_ca is not None and certificate is None:
        raise ConfigError("--client-ca: needs --certificate and --private-key as well")
    for path in (certificate, private_key, client_ca):
        if path is not None and not path.is_file():
            raise ConfigError(f"{path}: no such file; name a file in PEM form")
    if not is_near(address) and certificate is None:
        raise ConfigError(
            f"--listen {listen}: an address of a network needs TLS: give --certificate and "
            "--private-key, or listen on 127.0.0.1 and look through ssh -L"
        )
    names = [name if host_and_port(name)[1] else f"{name}:{port}" for name in hosts]
    is_own = not ipaddress.ip_address(address).is_unspecified and not is_near(address)
    own = [_shown(address)] if is_own else []
    names += [f"{name}:{port}" for name in (*own, *LOOPBACK)]
    return Listening(
        address=address,
        port=port,
        hosts=(*names, *_without_port(names, is_tls=certificate is not None)),
        certificate=certificate,
        private_key=private_key,
        client_ca=client_ca,
    )


def host_and_port(host: str) -> tuple[str, str]:
    """Return name and port of what a browser calls us by; no port is empty."""
    name, _, port = host.rpartition(":")
    return (name, port) if port.isdigit() else (host, "")


def _without_port(hosts: list[str], *, is_tls: bool) -> list[str]:
    """Return the names whose port is that of a scheme that is spoken here, without it."""
    ports = (HTTP_PORT, HTTPS_PORT) if is_tls else (HTTP_PORT,)
    return [name for name, port in map(host_and_port, hosts) if port in ports]


def _shown(address: str) -> str:
    return f"[{address}]" if ":" in address else address


def _address(listen: str) -> tuple[str, int]:
    host, _, number = listen.rpartition(":")
    host = host.removeprefix("[").removesuffix("]")
    try:
        address = str(ipaddress.ip_address("127.0.0.1" if host == "localhost" else host))
        port = int(number)
    except ValueError:
        port, address = 0, ""
    if not (address and 1 <= port <= 65535):
        raise ConfigError(f"--listen {listen}: ADDRESS:PORT is needed, such as 127.0.0.1:{PORT}")
    return address, port
