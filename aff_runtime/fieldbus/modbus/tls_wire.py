"""Modbus/TCP Security: the same frames in TLS (port 802), both sides with certificates."""

from __future__ import annotations

import select
import ssl
from pathlib import Path
from typing import Final

from aff_runtime.base.errors import ConfigError
from aff_runtime.fieldbus.modbus.byte_stream import CLOSED, Connecting
from aff_runtime.fieldbus.modbus.tcp_wire import TcpWire

_NS_PER_MS: Final = 1_000_000
_OTHER_NAME: Final = (62, 64)  # of OpenSSL: host name and IP address mismatch


def client_context(
    ca: Path, certificate: Path | None, key: Path | None, crl: Path | None = None
) -> ssl.SSLContext:
    """Return a TLS 1.2+ context that checks the server against ``ca`` and shows our certificate.

    The server's name counts where it belongs, in subjectAltName, and not in the common name. With
    ``crl`` a server whose certificate has been taken back is refused.

    Raises
    ------
    ConfigError
        A file cannot be used.
    """
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    context.minimum_version = ssl.TLSVersion.TLSv1_2
    context.hostname_checks_common_name = False
    files = [name for name in (ca, certificate, key, crl) if name is not None]
    try:
        context.load_verify_locations(ca)
        if certificate is not None:
            context.load_cert_chain(certificate, key)
        if crl is not None:
            context.load_verify_locations(crl)
            context.verify_flags |= ssl.VERIFY_CRL_CHECK_LEAF
    except (OSError, ssl.SSLError) as error:
        given = ", ".join(str(name) for name in files)
        missing = [str(name) for name in files if not name.is_file()]
        what = (
            f"{missing[0]} is not there"
            if missing
            else f"{given}: no PEM files that fit ({error})"
        )
        raise ConfigError(
            f"gateway.modbus_tcp.tls: {what}. Put PEM files where tls: names them"
        ) from error
    return context


class TlsWire:
    """``ByteStream`` over TLS; connecting is TCP first, then the handshake, a step each tick.

    Parameters
    ----------
    host, port : the server.
    context : certificates.
    server_name : name in the server's certificate.
    """

    lossy = False

    def __init__(self, host: str, port: int, context: ssl.SSLContext, server_name: str) -> None:
        self._tcp = TcpWire(host, port)
        self._context = context
        self._server_name = server_name
        self._tls: ssl.SSLSocket | None = None
        self._refused = ""

    @property
    def why_closed(self) -> str:
        """Why the last attempt failed: of the handshake, or else of TCP."""
        return self._refused or self._tcp.why_closed

    def start_connect(self) -> bool:
        """Begin a connection attempt."""
        self.close(abort=True)
        self._refused = ""
        return self._tcp.start_connect()

    def connecting(self) -> Connecting:
        """Move the attempt one step, without waiting."""
        if self._tls is None:
            state = self._tcp.connecting()
            if state is not Connecting.UP:
                return state
            raw = self._tcp.detach()
            if raw is None:
                return Connecting.FAILED
            try:
                self._tls = self._context.wrap_socket(
                    raw, server_hostname=self._server_name, do_handshake_on_connect=False
                )
            except (OSError, ValueError) as error:
                return self._failed(error)
        try:
            self._tls.do_handshake()
        except (ssl.SSLWantReadError, ssl.SSLWantWriteError):
            return Connecting.PENDING
        except (OSError, ValueError) as error:
            return self._failed(error)
        return Connecting.UP

    def _failed(self, error: Exception) -> Connecting:
        said = str(error)
        if isinstance(error, ssl.SSLCertVerificationError) and error.verify_code in _OTHER_NAME:
            said += (
                f"; its certificate has no {self._server_name} in subjectAltName, and the common "
                "name does not count: correct server_name, or have the certificate made anew"
            )
        self._refused = f"TLS with {self._server_name}: {said}"
        return Connecting.FAILED

    def send(self, frame: bytes) -> bool:
        """Hand over the whole frame."""
        if self._tls is None:
            return False
        try:
            return self._tls.send(frame) == len(frame)
        except (OSError, ValueError):
            return False

    def receive(self, into: memoryview, wait_ns: int) -> int:
        """Wait at most ``wait_ns`` and read once; bytes read, 0 for none yet, -1 for closed."""
        tls = self._tls
        if tls is None:
            return CLOSED
        try:
            if wait_ns > 0 and not tls.pending():
                select.select((tls,), (), (), wait_ns // _NS_PER_MS * 1e-3 or wait_ns * 1e-9)
            count = tls.recv_into(into)
        except (ssl.SSLWantReadError, ssl.SSLWantWriteError):
            return 0
        except (OSError, ValueError):
            return CLOSED
        return count or CLOSED

    def close(self, *, abort: bool) -> None:
        """Close; ``abort`` resets the connection."""
        tls, self._tls = self._tls, None
        if tls is not None:
            self._tcp.adopt(tls)
        self._tcp.close(abort=abort)
