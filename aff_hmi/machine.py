"""What the screen sees of its own machine: steps of the clock, and the end of a certificate."""

from __future__ import annotations

import ssl
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path

from aff_runtime.base.ports import Clock

STEP_S = 0.5  # what slewing to a time server does in 1000 s; two looks are 0.6 s apart at most
SHOWN_NS = 600_000_000_000  # a step is over at once: for so long it is told
_BEGIN, _END = "-----BEGIN CERTIFICATE-----", "-----END CERTIFICATE-----"
_SEQUENCE, _CONTEXT_0, _UTC_TIME = 0x30, 0xA0, 0x17
_S = 1e-9


class Machine:
    """Compares the wall clock with the monotonic one, and knows when certificates end.

    Parameters
    ----------
    wall : returns wall time, s since 1970.
    certificates : files in use, PEM; read once, as the server does.
    """

    def __init__(
        self, clock: Clock, wall: Callable[[], float], certificates: tuple[Path, ...] = ()
    ) -> None:
        self._clock = clock
        self._wall = wall
        self._ends_s = min((end for path in certificates for end in ends_of(path)), default=None)
        self._ahead_s: float | None = None
        self._step_s = 0.0
        self._stepped_ns = 0

    def look(self) -> None:
        """Take note of the clock."""
        now_ns = self._clock.now_ns()
        ahead_s = self._wall() - now_ns * _S
        before_s, self._ahead_s = self._ahead_s, ahead_s
        if before_s is not None and abs(ahead_s - before_s) > STEP_S:
            self._step_s, self._stepped_ns = ahead_s - before_s, now_ns
        elif now_ns - self._stepped_ns > SHOWN_NS:
            self._step_s = 0.0

    @property
    def clock_step_s(self) -> float:
        """The last step of the clock, s, forward positive; 0 when there was none lately."""
        return self._step_s

    @property
    def certificate_s(self) -> float | None:
        """Time until the first certificate ends, s; None where there is none."""
        return None if self._ends_s is None else self._ends_s - self._wall()


def ends_of(path: Path) -> tuple[float, ...]:
    """Return when the certificates of a file end, s since 1970; none of what cannot be read."""
    try:
        text = path.read_text(encoding="ascii")
        return tuple(_not_after(ssl.PEM_cert_to_DER_cert(one)) for one in _blocks(text))
    except (OSError, ValueError, IndexError):
        return ()


def _blocks(text: str) -> Iterator[str]:
    for part in text.split(_BEGIN)[1:]:
        yield f"{_BEGIN}{part.partition(_END)[0]}{_END}"


def _not_after(der: bytes) -> float:
    """Return the end of the validity of an X.509 certificate (RFC 5280, 4.1), s since 1970."""
    inside = _body(_body(der, _SEQUENCE)[0], _SEQUENCE)[0]  # of Certificate: of TBSCertificate
    if inside[0] == _CONTEXT_0:  # version
        inside = _body(inside, _CONTEXT_0)[1]
    for _ in range(3):  # serial number, signature algorithm, issuer
        inside = _body(inside, inside[0])[1]
    _, rest = _body(_body(inside, _SEQUENCE)[0], None)
    kind, (text, _) = rest[0], _body(rest, None)
    digits = text.decode("ascii")
    if kind == _UTC_TIME:  # two digits of the year: 50 to 99 are of 1900
        digits = f"{'19' if digits[:2] >= '50' else '20'}{digits}"
    return datetime.strptime(digits, "%Y%m%d%H%M%SZ").replace(tzinfo=UTC).timestamp()


def _body(der: bytes, kind: int | None) -> tuple[bytes, bytes]:
    """Return the content of the first element and what follows it.

    Raises
    ------
    ValueError
        When it is of another kind, or longer than what there is.
    """
    if kind is not None and der[0] != kind:
        raise ValueError(f"element {der[0]:#x} where {kind:#x} is expected")
    length, begin = der[1], 2
    if length & 0x80:
        begin += length & 0x7F
        length = int.from_bytes(der[2:begin], "big")
    if begin + length > len(der):
        raise ValueError("cut off")
    return der[begin : begin + length], der[begin + length :]
