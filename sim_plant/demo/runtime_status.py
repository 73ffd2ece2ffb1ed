"""What the demo reads of the runtime's status, as ``aff-runtime status --json`` prints it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

HELD_PHASE, CLAMPED = "HELD phase", "CLAMPED"
"""As ``status`` writes them."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RuntimeStatus:
    """How the service stands.

    Attributes
    ----------
    blocked_by : what stands against an armed output. ``alarm`` : the one that stands, in words.
    missed_ticks : grid points without a tick; None before the first one.
    trying : how a try of other settings stands; empty without one.
    unsure : orders that rest since their response is not sure, ``actuator.order``.
    giving_way : orders of which a limit takes a part, likewise.
    """

    state: str
    blocked_by: str
    alarm: str
    missed_ticks: int | None
    trying: str = ""
    unsure: tuple[str, ...] = ()
    giving_way: tuple[str, ...] = ()

    @classmethod
    def from_json(cls, said: Any) -> RuntimeStatus:
        """Return what the demo needs of the answer."""
        missed = said.get("signals", {}).get("missed_count")
        return cls(
            state=said.get("state", ""),
            blocked_by=said.get("blocked_by", ""),
            alarm=said.get("alarm", {}).get("text", ""),
            missed_ticks=None if missed is None else round(missed),
            trying=said.get("trying", ""),
            unsure=_orders(said, HELD_PHASE),
            giving_way=_orders(said, CLAMPED),
        )


def _orders(said: Any, state: str) -> tuple[str, ...]:
    return tuple(
        f"{order['actuator']}.{order['name']}"
        for order in said.get("blocks", ())
        if order.get("state") == state
    )
