"""What the screen sees of its own machine: steps of the clock, and the end of a certificate."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from aff_runtime.base.ports import Clock
from aff_runtime.config.x509 import CERTIFICATE, pem_blocks, validity

STEP_S = 0.5  # what slewing to a time server does in 1000 s; two looks are 0.6 s apart at most
SHOWN_NS = 600_000_000_000  # a step is over at once: for so long it is told
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
        blocks = pem_blocks(path.read_text(encoding="ascii"), CERTIFICATE)
        return tuple(validity(der)[1].timestamp() for der in blocks)
    except (OSError, ValueError):
        return ()
