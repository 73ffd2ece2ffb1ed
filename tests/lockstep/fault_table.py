"""What can go wrong between the line and the runtime, and what must then be true.

One table for two suites: ``tests/lockstep`` in virtual time, ``tests/hil`` between real processes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

ZERO_WITHIN_S = 0.300
LASTS_S = 0.8
LIMITS_M_S = (0.05, 0.04)  # of config/euclid_blocks.yaml, in the order of its actuators
WORKING_M_S = 0.002  # a correction that is really at work
Applied = Sequence[tuple[float, Sequence[float]]]  # plant time, s; correction per actuator, m/s


@dataclass(frozen=True, slots=True, kw_only=True)
class Trouble:
    """One fault and its consequence.

    Attributes
    ----------
    spec : fault of the plant, without its times.
    alarm : name of the event that the runtime must report.
    latched : an operator's edge is needed after it; otherwise the operator's word still stands.
    trips : the PLC's own watchdog must act as well.
    """

    spec: str
    alarm: str
    latched: bool = True
    trips: bool = False

    def at(self, start_s: float) -> str:
        """Return the fault as the plant reads it, ``start_s`` from now."""
        return f"{self.spec}@{start_s}:{LASTS_S}"


TROUBLES = {
    "mute": Trouble(spec="mute", alarm="PLC_STALE", trips=True),
    "frozen heartbeat": Trouble(spec="freeze", alarm="PLC_STALE"),
    "restarting": Trouble(spec="restart", alarm="PLC_STALE", trips=True),
    "gone": Trouble(spec="refuse", alarm="PLC_STALE", trips=True),
    "dropped connections": Trouble(spec="drop", alarm="PLC_STALE", trips=True),
    "exception 6": Trouble(spec="busy", alarm="PLC_STALE", trips=True),
    "late replies": Trouble(spec="delay=20", alarm="PLC_STALE"),
    "half replies": Trouble(spec="partial", alarm="PLC_STALE"),
    "foreign replies": Trouble(spec="tid", alarm="PLC_STALE"),
    "short replies": Trouble(spec="short", alarm="PLC_STALE"),
    "another master comes last": Trouble(spec="last", alarm="SECOND_MASTER"),
    "swapped words": Trouble(spec="swap", alarm="TENSION_IMPLAUSIBLE"),
    "absurd tension": Trouble(spec="absurd", alarm="TENSION_IMPLAUSIBLE"),
    "one absurd tension": Trouble(spec="absurd=pullroll_tension_N", alarm="TENSION_IMPLAUSIBLE"),
    "NaN tension": Trouble(spec="nan", alarm="TENSION_IMPLAUSIBLE"),
    "stuck tension": Trouble(spec="stuck", alarm="TENSION_IMPLAUSIBLE"),
    "absurd speed": Trouble(spec="absurd=line_speed_m_s", alarm="SIGNAL_IMPLAUSIBLE"),
    "web lost": Trouble(spec="permissive=WEB_INTACT", alarm="PERMISSIVE_LOST", latched=False),
    "stop": Trouble(spec="permissive=ESTOP_OK", alarm="PERMISSIVE_LOST", latched=False),
    "splice": Trouble(spec="splice", alarm="SPLICE", latched=False),
}


def peak(rows: Applied, start_s: float, end_s: float) -> float:
    """Return the largest |correction| of any actuator in a span of plant time, m/s."""
    found = [abs(v) for t, values in rows if start_s <= t <= end_s for v in values]
    assert found, f"no sample between {start_s} and {end_s} s"
    return max(found)


def assert_never_above_limit(rows: Applied) -> None:
    """Every sample is within the limits of the site file."""
    for time_s, values in rows:
        for value, limit in zip(values, LIMITS_M_S, strict=True):
            assert abs(value) <= limit + 1e-12, f"{value} m/s at {time_s} s"


def zero_after_s(rows: Applied, start_s: float) -> float:
    """Return how long after ``start_s`` the correction was last not zero, s."""
    left = [t for t, values in rows if t >= start_s and any(v != 0.0 for v in values)]
    return (left[-1] - start_s) if left else 0.0
