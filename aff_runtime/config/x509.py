"""The few fields of certificates and of revocation lists that a check looks at (RFC 5280)."""

from __future__ import annotations

import binascii
import re
from base64 import b64decode
from datetime import UTC, datetime

CERTIFICATE, REVOCATION_LIST = "CERTIFICATE", "X509 CRL"
_INTEGER, _SEQUENCE, _VERSION, _UTC_TIME, _GENERAL_TIME = 0x02, 0x30, 0xA0, 0x17, 0x18


def pem_blocks(text: str, label: str) -> list[bytes]:
    """Return every PEM block of one kind in ``text``, as DER; none when one cannot be read."""
    pattern = f"-----BEGIN {label}-----(.*?)-----END {label}-----"
    try:
        return [b64decode("".join(body.split())) for body in re.findall(pattern, text, re.DOTALL)]
    except (ValueError, binascii.Error):
        return []


def validity(der: bytes) -> tuple[datetime, datetime]:
    """Return from when until when a certificate is in force (4.1.2.5).

    Raises
    ------
    ValueError
        This is no certificate.
    """
    at, _ = _certificate(der)
    first, at = _time(der, at)
    return first, _time(der, at)[0]


def subject(der: bytes) -> bytes:
    """Return the name of a certificate's owner, as DER (4.1.2.6).

    Raises
    ------
    ValueError
        This is no certificate.
    """
    _, at = _certificate(der)
    return der[at : _element(der, at)[2]]


def list_issuer(der: bytes) -> bytes:
    """Return the name of who issued a revocation list, as DER (5.1.2.3).

    Raises
    ------
    ValueError
        This is no revocation list.
    """
    begin, end = _list_issuer(der)
    return der[begin:end]


def list_dates(der: bytes) -> tuple[datetime, datetime | None]:
    """Return when a revocation list was issued, and when the next is due (5.1.2.4, 5.1.2.5).

    Raises
    ------
    ValueError
        This is no revocation list.
    """
    _, at = _list_issuer(der)
    issued, at = _time(der, at)
    if at >= len(der) or der[at] not in (_UTC_TIME, _GENERAL_TIME):
        return issued, None
    return issued, _time(der, at)[0]


def _certificate(der: bytes) -> tuple[int, int]:
    """Return where the dates begin and where the owner's name begins."""
    _, at, _ = _element(der, 0)  # Certificate
    _, at, _ = _element(der, at)  # tbsCertificate
    tag, _, end = _element(der, at)
    at = end if tag == _VERSION else at
    for _ in range(3):  # serialNumber, signature, issuer
        at = _element(der, at)[2]
    tag, begin, end = _element(der, at)
    if tag != _SEQUENCE:
        raise ValueError("no validity")
    return begin, end


def _list_issuer(der: bytes) -> tuple[int, int]:
    """Return begin and end of the issuer's name of a revocation list."""
    _, at, _ = _element(der, 0)  # CertificateList
    _, at, _ = _element(der, at)  # tbsCertList
    tag, _, end = _element(der, at)
    at = end if tag == _INTEGER else at  # version
    at = _element(der, at)[2]  # signature
    tag, _, end = _element(der, at)
    if tag != _SEQUENCE:
        raise ValueError("no issuer")
    return at, end


def _time(der: bytes, at: int) -> tuple[datetime, int]:
    """Return the time at ``at`` and where the next element begins."""
    tag, begin, end = _element(der, at)
    try:
        text = der[begin:end].decode("ascii")
    except UnicodeDecodeError as error:
        raise ValueError("no time") from error
    if tag == _UTC_TIME:  # two digits of the year: 50 to 99 are of 1900
        text = f"{'19' if text[:2] >= '50' else '20'}{text}"
    return datetime.strptime(text, "%Y%m%d%H%M%SZ").replace(tzinfo=UTC), end


def _element(der: bytes, at: int) -> tuple[int, int, int]:
    """Return tag, begin and end of the content of the DER element at ``at``."""
    try:
        tag, length = der[at], der[at + 1]
    except IndexError as error:
        raise ValueError("it ends too early") from error
    begin = at + 2
    if length & 0x80:
        size = length & 0x7F
        length = int.from_bytes(der[begin : begin + size], "big")
        begin += size
    return tag, begin, begin + length
