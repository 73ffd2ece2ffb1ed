"""The certificates that a site names: there, readable, belonging together, in force."""

from __future__ import annotations

import re
import ssl
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path

from aff_runtime.base.clock import wall_time_s
from aff_runtime.config.models import Site, Tls
from aff_runtime.config.plain_file import read_plain
from aff_runtime.config.rules.issue import Issue

_PATH = ("gateway", "modbus_tcp", "tls")
_PEM = re.compile(r"-----BEGIN CERTIFICATE-----.*?-----END CERTIFICATE-----", re.DOTALL)
_SEQUENCE, _VERSION, _UTC_TIME = 0x30, 0xA0, 0x17


def issues(site: Site, folder: Path, now_s: float | None = None) -> Iterator[Issue]:
    """Yield what is wrong with the files; dates only warn, for the clock may be the one to blame.

    Parameters
    ----------
    folder : where relative names begin.
    now_s : wall clock, s; absent: the machine's.
    """
    tcp = site.gateway.modbus_tcp
    if tcp is None or tcp.tls is None:
        return
    tls = tcp.tls
    if tls.private_key is not None and tls.certificate is None:
        yield Issue(
            path=(*_PATH, "private_key"),
            text="a key without certificate: serves no one. Name the certificate, or neither.",
        )
        return
    found = list(_unreadable(tls, folder)) or list(_unfit(tls, folder))
    yield from found
    if not found:
        yield from _out_of_date(tls, folder, wall_time_s() if now_s is None else now_s)


def _named(tls: Tls) -> dict[str, str]:
    names = {"ca": tls.ca, "certificate": tls.certificate, "private_key": tls.private_key}
    return {key: name for key, name in names.items() if name is not None}


def _unreadable(tls: Tls, folder: Path) -> Iterator[Issue]:
    for key, name in _named(tls).items():
        try:
            read_plain(folder / name)
        except ValueError as error:
            yield Issue(path=(*_PATH, key), text=f"{folder / name} {error}. Correct the name.")
        except OSError as error:
            text = (
                f"{folder / name} cannot be read ({error.strerror}). Put the PEM file there, "
                "readable by the user of the service, or correct the name."
            )
            yield Issue(path=(*_PATH, key), text=text)


def _unfit(tls: Tls, folder: Path) -> Iterator[Issue]:
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)
    try:
        context.load_verify_locations(folder / tls.ca)
    except (OSError, ValueError) as error:
        text = f"{tls.ca} holds no PEM certificate that can be used ({error})."
        yield Issue(path=(*_PATH, "ca"), text=text)
    if tls.certificate is None:
        return
    if not _certificates(folder / tls.certificate):
        yield Issue(
            path=(*_PATH, "certificate"), text=f"{tls.certificate} holds no PEM certificate."
        )
        return
    key = "private_key" if tls.private_key is not None else "certificate"
    name = tls.private_key or tls.certificate
    try:
        context.load_cert_chain(folder / tls.certificate, folder / name, password=_nobody)
    except ssl.SSLError as error:
        text = f"{name} holds no PEM key that can be used ({error})."
        if error.reason == "KEY_VALUES_MISMATCH":
            text = f"the key in {name} does not belong to the certificate in {tls.certificate}."
        yield Issue(path=(*_PATH, key), text=text)
    except (OSError, ValueError) as error:
        yield Issue(path=(*_PATH, key), text=f"{name}: {error}.")


def _nobody() -> str:
    raise ValueError(
        "the key is encrypted, and nobody is there to type its password. Store it without one, "
        "readable by the user of the service alone"
    )


def _out_of_date(tls: Tls, folder: Path, now_s: float) -> Iterator[Issue]:
    now = datetime.fromtimestamp(now_s, UTC)
    for key, name in _named(tls).items():
        for der in _certificates(folder / name) if key != "private_key" else ():
            try:
                first, last = validity(der)
            except ValueError:
                continue  # whether it can be used at all, TLS has said
            text = ""
            if now > last:
                text = f"expired on {last:%Y-%m-%d}: no connection is made with it. Renew it"
            elif now < first:
                text = f"is in force from {first:%Y-%m-%d} on: no connection before"
            if text:
                text = f"a certificate in {name} {text} (this machine's clock: {now:%Y-%m-%d})."
                yield Issue(path=(*_PATH, key), text=text, warning=True)


def _certificates(path: Path) -> list[bytes]:
    """Return every PEM certificate of a file, as DER."""
    text = path.read_text(encoding="latin-1")
    try:
        return [ssl.PEM_cert_to_DER_cert(pem) for pem in _PEM.findall(text)]
    except ValueError:
        return []


def validity(der: bytes) -> tuple[datetime, datetime]:
    """Return from when until when a certificate is in force (RFC 5280, 4.1).

    Raises
    ------
    ValueError
        This is no certificate.
    """
    try:
        _, at, _ = _element(der, 0)  # Certificate
        _, at, _ = _element(der, at)  # tbsCertificate
        tag, _, end = _element(der, at)
        at = end if tag == _VERSION else at
        for _ in range(3):  # serialNumber, signature, issuer
            _, _, at = _element(der, at)
        tag, at, _ = _element(der, at)
        if tag != _SEQUENCE:
            raise ValueError("no validity")
        times = []
        for _ in range(2):
            tag, begin, at = _element(der, at)
            form = "%y%m%d%H%M%SZ" if tag == _UTC_TIME else "%Y%m%d%H%M%SZ"
            text = der[begin:at].decode("ascii")
            times.append(datetime.strptime(text, form).replace(tzinfo=UTC))
    except (IndexError, UnicodeDecodeError) as error:
        raise ValueError("no certificate") from error
    return times[0], times[1]


def _element(der: bytes, at: int) -> tuple[int, int, int]:
    """Return tag, begin and end of the content of the DER element at ``at``."""
    tag, length = der[at], der[at + 1]
    begin = at + 2
    if length & 0x80:
        size = length & 0x7F
        length = int.from_bytes(der[begin : begin + size], "big")
        begin += size
    return tag, begin, begin + length
