"""What the control process answers, as frozen dataclasses that need no other package.

Who only asks a service (`arm`, `bypass`, `status`) imports these and not the site's models.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class Reply:
    """Answer to the message of this ``id``; ``state`` and ``duration_s`` where they say more.

    ``rolls`` : of which something was forgotten, where that was asked.
    """

    id: int
    ok: bool
    message: str = ""
    state: str = ""
    duration_s: float | None = None
    rolls: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ProbeResult:
    """One measured response; ``text`` is its file."""

    actuator: str
    sign: int
    remarks: tuple[str, ...]
    delay_s: float
    text: str
