"""Where the screen listens: loopback, unless TLS is set."""

from __future__ import annotations

import ipaddress
from dataclasses import dataclass
from pathlib import Path

from aff_runtime.base.errors import ConfigError

PORT = 8480
LOOPBACK = ("127.0.0.1", "localhost", "[::1]")


@dataclass(frozen=True, slots=True, kw_only=True)
class Listening:
    """Address, names and TLS.

    Attributes
    ----------
    hosts : ``name:port`` that a browser may call this screen by.
    client_ca : whose certificates a browser must show; None asks for none.
    """

    address: str = "127.0.0.1"
    port: int = PORT
    hosts: tuple[str, ...] = ()
    certificate: Path | None = None
    private_key: Path | None = None
    client_ca: Path | None = None

    @property
    def is_tls(self) -> bool:
        """Whether browsers come by https."""
        return self.certificate is not None

    @property
    def url(self) -> str:
        """What to type into a browser on this machine, or into one that knows the first name."""
        host = f"[{self.address}]" if ":" in self.address else self.address
        first = self.hosts[0] if self.hosts and not _is_loopback(self.address) else ""
        return f"{'https' if self.is_tls else 'http'}://{first or f'{host}:{self.port}'}/"


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
    if not _is_loopback(address) and certificate is None:
        raise ConfigError(
            f"--listen {listen}: an address of a network needs TLS: give --certificate and "
            "--private-key, or listen on 127.0.0.1 and look through ssh -L"
        )
    names = tuple(name if _has_port(name) else f"{name}:{port}" for name in hosts)
    own = LOOPBACK if _is_loopback(address) else (f"[{address}]" if ":" in address else address,)
    return Listening(
        address=address,
        port=port,
        hosts=(*names, *(f"{name}:{port}" for name in own)),
        certificate=certificate,
        private_key=private_key,
        client_ca=client_ca,
    )


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


def _is_loopback(address: str) -> bool:
    return ipaddress.ip_address(address).is_loopback


def _has_port(name: str) -> bool:
    return name.rpartition(":")[2].isdigit() and not name.endswith("]")
