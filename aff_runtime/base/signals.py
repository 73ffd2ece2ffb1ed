"""What passes between the rooms in one control tick.

Sign and zero conventions, once for the whole product:

    unwind                                   driven roller
      (  )-----web----->  o   o   o ----->  ( )
     omega > 0 in the direction of transport, so web speed v = p * omega > 0
     torque > 0 accelerates the web; tension > 0 pulls; strain 0 is unstretched
     theta = integral of omega: the angle of a body in the direction of transport
     correction > 0 adds to the velocity reference (m/s) or the torque reference (N m)

All numbers are SI here; plant units stop in ``fieldbus`` and ``config``.
A missing or stale number is NaN in ``values``; ``fresh`` says whether the PLC's heartbeat moved.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum, IntFlag

NO_ECHO = -1
"""``echo_age`` where no heartbeat of ours was read back: the site maps no such word, or the
exchange failed. Any other age is in ticks since we sent the heartbeat that the PLC shows."""


class Status(IntFlag):
    """Status word PLC -> AFF, bit for bit."""

    LINE_RUN = 1
    AFF_ENABLE_REQUEST = 2
    REMOTE = 4
    WEB_INTACT = 8
    SPLICE_ACTIVE = 16
    TENSION_VALID = 32
    ESTOP_OK = 64
    RESET_EDGE = 128


class StateBits(IntFlag):
    """State word AFF -> PLC, bit for bit."""

    READY = 1
    ARMED = 2
    ACTIVE = 4
    FADING = 8
    BYPASS = 16
    SATURATED = 32
    COMM_WARN = 64
    FAULT = 128


class State(IntEnum):
    """State of the guard; it starts in FAULT and only an operator's edge leaves it."""

    FAULT = 0
    OFF = 1
    READY = 2
    ARMED = 3
    ACTIVE = 4
    FADING = 5
    BYPASS = 6
    SHADOW = 7


LATCHED_STATES = (State.FAULT, State.BYPASS)
"""What only an operator's edge leads out of."""


class Outcome(IntEnum):
    """How one wire transaction ended."""

    OK = 0
    TIMEOUT = 1
    NOT_CONNECTED = 2
    EXCEPTION = 3
    BAD_REPLY = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class Snapshot:
    """One consistent set of readings.

    Attributes
    ----------
    tick : number of the control tick.
    t_ns : monotonic time at which the reply was complete, ns.
    outcome : how the transaction ended; ``values`` are NaN unless OK.
    fresh : True when the PLC heartbeat moved since the last good transaction.
    age_s : time since the PLC heartbeat last moved, s.
    plc_heartbeat, status, roll_id : words of the PLC.
    values : SI value per channel, in the order of the site's channel table.
    echo_age : how many ticks ago we sent the heartbeat that the PLC shows as taken, modulo 2^16;
        ``NO_ECHO`` where the site maps no such word, or unless OK.
    applied : per actuator the correction that the PLC says it adds, SI; NaN for one that it does
        not show, empty where it shows none, or unless OK.
    command_sent : the exchange carried the command; False for one that only read.
    """

    tick: int
    t_ns: int
    outcome: Outcome
    fresh: bool
    age_s: float
    plc_heartbeat: int
    status: int
    roll_id: int
    values: tuple[float, ...]
    echo_age: int = NO_ECHO
    applied: tuple[float, ...] = ()
    command_sent: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Permission:
    """What the guard allows the law in this tick.

    ``adapt`` False freezes every weight. ``applied_ratio`` is, per actuator, the share of the
    law's last output that really went out (envelope times limit scaling, 0..1); the law projects
    its weights by ``limit_ratio`` (limit scaling alone) so that a limit never winds up.
    ``headroom`` is, per actuator, the largest ``peak_bound`` and ``slew_bound`` that go out
    unscaled; empty where no guard limits.
    """

    adapt: bool
    applied_ratio: tuple[float, ...]
    limit_ratio: tuple[float, ...]
    headroom: tuple[tuple[float, float], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ActuatorStep:
    """What a law wants of one actuator, with the bounds the guard needs to scale it whole.

    ``value`` in the actuator's SI unit (m/s or N m); ``peak_bound`` >= |value| at any phase of
    its sinusoids (sum of amplitudes); ``slew_bound`` >= |d value/dt| (sum of n*omega*amplitude).
    """

    value: float
    peak_bound: float
    slew_bound: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Command:
    """What goes to the PLC in one tick.

    Attributes
    ----------
    heartbeat : ours, one more every tick. ``echo`` : the PLC's as last taken.
    state_bits : of ``StateBits``. ``alarm`` : code of ``events.TABLE``.
    corrections, limits : per actuator, SI.
    config_revision : low 16 bits of the revision.
    """

    heartbeat: int
    state_bits: int
    echo: int
    corrections: tuple[float, ...]
    alarm: int
    limits: tuple[float, ...]
    config_revision: int
