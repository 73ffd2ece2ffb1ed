"""What the PLC's words say about the line: permissives, splice, speed and believable signals."""

from __future__ import annotations

from math import nan

from aff_runtime.base.events import BY_NAME
from aff_runtime.base.signals import Outcome, Snapshot, Status
from aff_runtime.safety.causes import bit
from aff_runtime.safety.params import GuardParams
from aff_runtime.safety.plausibility import ChannelCheck, RadiusCheck

_OK = Outcome.OK
_PERMISSIVE_LOST = bit("PERMISSIVE_LOST")
_SPLICE = bit("SPLICE")
_RADIUS_JUMP = bit("RADIUS_JUMP")
_RADIUS_CODE = BY_NAME["RADIUS_JUMP"].code
_SPLICE_ACTIVE = int(Status.SPLICE_ACTIVE)  # a plain number: `&` of a flag costs 2 us a tick


class LineCheck:
    """Turns readings into causes and into "may this output open by speed".

    Only good exchanges (``Outcome.OK``) are judged; between them the last judgement stands.
    Never raises.

    Attributes
    ----------
    gates : per actuator, whether the line is fast enough (with hysteresis).
    unbelievable : first channel that cannot be true by the code of its event; empty when all can.
    believes : whether the law may use the last readings. A jump of a radius alone is no reason
        against that: the correction fades for it, and tension and speed are as good as before.
    """

    def __init__(self, params: GuardParams) -> None:
        self._signal_causes = 0
        self._status = 0
        self._roll_id: int | None = None
        self._splice_until_ns: int | None = None
        self._judged_ns: int | None = None
        self.gates = [False] * len(params.actuators)
        self.unbelievable: dict[int, str] = {}
        self.believes = True
        self.adopt(params)

    def adopt(self, params: GuardParams) -> None:
        """Take new settings; the line's status stays, histories of signals start again."""
        self._params = params
        self._permissives = params.permissives.all_bits
        self._need = 0
        for permissive in self._permissives:
            self._need |= int(permissive)
        self._channels = tuple(ChannelCheck(channel) for channel in params.channels)
        self._radii = tuple(RadiusCheck(radius) for radius in params.radii)

    @property
    def fast_enough(self) -> bool:
        """Whether the line is fast enough for at least one output."""
        return True in self.gates

    def confirm_rolls(self) -> None:
        """Accept the next radius of every roll: the operator has looked."""
        for radius in self._radii:
            radius.forget()
        self._signal_causes &= ~_RADIUS_JUMP

    def missing(self) -> tuple[str, ...]:
        """Return the permissives that are missing, as ``WEB_INTACT=0``."""
        return tuple(f"{one.name}=0" for one in self._permissives if not self._status & one)

    def judge(self, snapshot: Snapshot, now_ns: int) -> int:
        """Return the causes present in the line at ``now_ns`` as a mask of event codes."""
        if snapshot.outcome is _OK:
            self._status = snapshot.status
            self._watch_rolls(snapshot.roll_id, now_ns)
            if snapshot.fresh:
                self._judge_signals(snapshot.values, now_ns)
        causes = self._signal_causes
        if self._status & self._need != self._need:
            causes |= _PERMISSIVE_LOST
        if self._is_splicing(now_ns):
            causes |= _SPLICE
        return causes

    def _watch_rolls(self, roll_id: int, now_ns: int) -> None:
        if self._roll_id is not None and roll_id != self._roll_id:
            self._splice_until_ns = now_ns + round(self._params.splice_settle_s * 1e9)
        self._roll_id = roll_id

    def _is_splicing(self, now_ns: int) -> bool:
        if self._status & _SPLICE_ACTIVE:
            return True
        if self._splice_until_ns is not None and now_ns >= self._splice_until_ns:
            self._splice_until_ns = None
        return self._splice_until_ns is not None

    def _judge_signals(self, values: tuple[float, ...], now_ns: int) -> None:
        elapsed_s = 0.0 if self._judged_ns is None else (now_ns - self._judged_ns) * 1e-9
        self._judged_ns = now_ns
        if elapsed_s > self._params.freshness.fault_after_s:
            for channel in self._channels:
                channel.forget()
        was_fast_enough = self.fast_enough
        self._set_gates(values)
        running = self._status & self._need == self._need and (was_fast_enough or self.fast_enough)
        causes = 0
        possible = True
        unbelievable: dict[int, str] = {}
        for channel in self._channels:
            value = _value(values, channel.params.channel)
            if not channel.is_plausible(value, elapsed_s, running):
                causes |= 1 << channel.params.event
                unbelievable.setdefault(channel.params.event, channel.params.name)
            possible = possible and channel.is_possible(value)
        self.believes = causes == 0 and possible
        splicing = self._is_splicing(now_ns)
        for radius in self._radii:
            if splicing:
                radius.forget()
            elif not radius.is_plausible(_value(values, radius.params.channel)):
                causes |= _RADIUS_JUMP
                unbelievable.setdefault(_RADIUS_CODE, radius.params.name)
        self._signal_causes = causes
        self.unbelievable = unbelievable

    def _set_gates(self, values: tuple[float, ...]) -> None:
        channel = self._params.line_speed_channel
        for index, actuator in enumerate(self._params.actuators):
            if channel is None:
                self.gates[index] = True
                continue
            release = self._params.speed_release_ratio if self.gates[index] else 1.0
            self.gates[index] = _value(values, channel) > actuator.active_above_m_s * release


def _value(values: tuple[float, ...], index: int) -> float:
    return values[index] if 0 <= index < len(values) else nan
