"""One moment of the line as the overview shows it: pure, from what was seen.

A number that is not known is None, never 0. Ages go with everything; whether they are too old for
a number to be shown is decided where it is shown, for there the last link ends.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from itertools import groupby

from aff_hmi.condition import RANK
from aff_hmi.layout import Layout
from aff_hmi.notices import Notice, is_probing, notices_of
from aff_hmi.objections import LONGEST as LONGEST_REASON
from aff_hmi.reason import SHAPES, STARTING, Reason, explained, reason_of
from aff_hmi.recent_window import WINDOW_S
from aff_hmi.watch import Observed
from aff_hmi.words import N_, Say
from aff_runtime.app.report.alarm_table import Priority
from aff_runtime.app.report.block_status import SHAPE
from aff_runtime.app.report.status_answer import ComingMeeting
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.base.channel_units import unit_of_channel
from aff_runtime.base.events import BY_CODE
from aff_runtime.base.numbers import finite_or_none
from aff_runtime.base.printable import printable
from aff_runtime.base.signals import State
from aff_runtime.core.order_status import OrderStatus

SHOWN_EVENTS = 6
TURNS = 2.0  # over which a law listens to one order
GONE = "GONE"
LOW = RANK[Priority.LOW]
BESIDE_A_TICK = "supervisor"  # a reason of a tick's state; without a fresh tick it is an old one
WHY_FROM = {STARTING: "facts", GONE: "hmi"}
NOT_IN_THE_WAY = (GONE, STARTING, State.ACTIVE.name, State.ARMED.name)
GOES_OUT = (State.ACTIVE, State.FADING)
NO_ANSWER = N_("no service answers; whether a correction goes out is not known here")
OTHER_RELEASE = N_(
    "the service is of another release than this screen; whether a correction goes out is not "
    "known here"
)
ONE_RELEASE = N_("install both of one release; until then ask `aff-runtime status`")
FIND_IT = N_("ask `aff-runtime status`; start it, or see its log: journalctl -u aff-runtime")
DOUBT = N_("the service does not believe it: stuck, no number, or out of range")
_IMPLAUSIBLE = re.compile(
    r"(TENSION_IMPLAUSIBLE|SIGNAL_IMPLAUSIBLE|RADIUS_JUMP) \((?P<channel>\w+)"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class Happened:
    """One event of the log; ``ago_s`` at the moment of the view."""

    name: str
    text: str
    ago_s: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Coming:
    """Orders that will meet; ``{radius}`` in the text stands for ``radius_mm``."""

    text: str
    radius_mm: int


@dataclass(frozen=True, slots=True, kw_only=True)
class View:
    """Everything that changes on the overview.

    Attributes
    ----------
    plc_age_s : of the PLC's data in the newest tick. ``tick_age_s`` : since a tick arrived.
    facts_age_s : since the supervisor spoke.
    plc_late_s, plc_dead_s : ages at which the service holds, and gives up.
    state, word, shape, why, to_do : the guard's state, in words; ``word`` is translated, and
        says that the state is not known where no tick says it.
    why_from : what has to be heard for ``why`` and ``to_do`` to be of now, as ``freshness.js``
        calls it: where no tick says the state, its reason is still known.
    also : all that stands against an armed output besides ``why``.
    heart : heartbeat value of the PLC; what moves on the screen moves by it.
    limits : of the outputs, by actuator, in the unit of the screen.
    values : numbers by slot. ``notes`` : words beside numbers, by slot.
    doubted : slots of what the guard does not believe now; they are not shown as alive.
    """

    layout: str
    plc_age_s: float | None = None
    tick_age_s: float | None = None
    facts_age_s: float | None = None
    plc_late_s: float = 0.0
    plc_dead_s: float = 0.0
    state: str = STARTING
    word: str = ""
    shape: str = ""
    why: str = ""
    to_do: str = ""
    why_from: str = BESIDE_A_TICK
    also: tuple[Reason, ...] = ()
    heart: int = 0
    config: str = ""
    limits: dict[str, float] = field(default_factory=dict)
    values: dict[str, float | None] = field(default_factory=dict)
    notes: dict[str, str] = field(default_factory=dict)
    doubted: tuple[str, ...] = ()
    coming: tuple[Coming, ...] = ()
    alarms: tuple[Notice, ...] = ()
    events: tuple[Happened, ...] = ()


def view_of(
    seen: Observed, layout: Layout, say: Say, standing: Mapping[str, str] | None = None
) -> View:
    """Return the view of one moment.

    Parameters
    ----------
    seen : what the watch knows. ``say`` : the reader's language.
    standing : names of the alarms that stand by their keys, see ``notices_of``.
    """
    facts, row = seen.facts, seen.row
    site = seen.site
    blocked = printable(facts.blocked, LONGEST_REASON) if facts is not None else ""
    state = state_of(seen)
    why, to_do = _why(seen, state, blocked, say, standing or {})
    alarms = notices_of(seen, state, say, standing)
    if state == State.ACTIVE.name and not is_probing(seen) and alarms and alarms[0].rank < LOW:
        to_do = alarms[0].to_do  # an output that works may ask for somebody, too
    notes: dict[str, str] = {}
    values: dict[str, float | None] = {}
    against = (blocked, *(facts.also_blocking if facts is not None else ()))
    doubted = tuple(dict.fromkeys(s for one in against for s in _doubted(seen, layout, one)))
    if row is not None:
        values = {slot: finite_or_none(value, 6) for slot, value in values_of(seen, row, layout)}
        notes = dict(_notes(seen, row, layout, values, say))
        notes |= {slot: say(DOUBT) for slot in doubted if slot in notes}
    return View(
        layout=layout.ident,
        plc_age_s=finite_or_none(row.plc_age_s, 6) if row is not None else None,
        tick_age_s=seen.tick_age_s if seen.writer_lives else None,
        facts_age_s=finite_or_none(seen.facts_age_s, 6) if seen.facts_age_s is not None else None,
        plc_late_s=site.hold_after_s if site is not None else 0.0,
        plc_dead_s=site.fault_after_s if site is not None else 0.0,
        state=state,
        word=say(WORDS[state]),
        shape=SHAPES.get(state, "?"),
        why=why,
        to_do=to_do,
        why_from=WHY_FROM.get(state, BESIDE_A_TICK),
        also=tuple(_also(seen, state, say)),
        heart=int(_finite(row.number("plc_heartbeat"))) if row is not None else 0,
        config=facts.status.config_hash[:8] if facts is not None else "",
        limits={output.actuator: output.limit for output in layout.outputs},
        values=values,
        notes=notes,
        doubted=doubted,
        coming=tuple(_coming(one, say) for one in facts.status.meetings) if facts else (),
        alarms=alarms,
        events=tuple(_events(seen, say)),
    )


WORDS = {
    State.FAULT.name: N_("FAULT"),
    State.OFF.name: N_("OFF"),
    State.READY.name: N_("READY"),
    State.ARMED.name: N_("ARMED"),
    State.ACTIVE.name: N_("ACTIVE"),
    State.FADING.name: N_("FADING"),
    State.BYPASS.name: N_("BYPASS"),
    State.SHADOW.name: N_("SHADOW"),
    STARTING: N_("UNKNOWN"),
    GONE: N_("UNKNOWN"),
}


def state_of(seen: Observed) -> str:
    """Return the guard's state, or what is there instead of one."""
    if seen.row is not None and seen.writer_lives:
        return seen.row.state.name
    return STARTING if seen.facts is not None and not seen.trouble else GONE


def _doubted(seen: Observed, layout: Layout, blocked: str) -> Iterator[str]:
    """Yield the slots of what comes from a signal that the guard names as not to be believed."""
    found = _IMPLAUSIBLE.match(blocked)
    if found is None:
        return
    channel = found["channel"]
    yield from (f"{slot}:{channel}" for slot in ("tension", "rms"))
    facts = seen.site
    for output in facts.outputs if facts is not None else ():
        if channel == output.signal:
            yield from (f"{one}:{output.actuator}" for one in ("now", "without", "reduction"))
    for roll in facts.rolls if facts is not None else ():
        if channel == roll.radius_channel:
            yield f"radius:{roll.name}"
    if channel == layout.speed:
        yield "speed"


def why_gone(seen: Observed) -> tuple[str, str]:
    """Return why nothing is heard of the service, and what to do, to be put into a language."""
    return (OTHER_RELEASE, ONE_RELEASE) if seen.other_protocol else (NO_ANSWER, FIND_IT)


def _why(
    seen: Observed, state: str, blocked: str, say: Say, standing: Mapping[str, str]
) -> tuple[str, str]:
    if state == GONE:
        why, to_do = why_gone(seen)
        return say(why), say(to_do)
    if state == STARTING and seen.facts is not None and not seen.facts.status.control_pid:
        why = say(N_("the control process has ended; it comes back idle"))
        return why, say(N_("see the log; then arm again"))
    if is_probing(seen):
        why = say(N_("the response is being measured: a small excitation goes out"))
        return why, say(N_("wait; bypass ends it"))
    reason = reason_of(
        state, seen.row.alarm_code if seen.row is not None else 0, blocked, say, standing
    )
    return reason.why, reason.to_do


def _also(seen: Observed, state: str, say: Say) -> Iterator[Reason]:
    """Yield what else stands against an armed output, where ``why`` says what does first."""
    if seen.facts is None or state in NOT_IN_THE_WAY or is_probing(seen):
        return
    for text in seen.facts.also_blocking:
        why, to_do = explained(printable(text, LONGEST_REASON), say)
        yield Reason(why=why, to_do=to_do)


def rests(state: State) -> bool:
    """Return whether an output is zero and stays so: it neither goes out, fades nor is armed."""
    return state not in (*GOES_OUT, State.ARMED)


def values_of(seen: Observed, row: TickRow, layout: Layout) -> Iterator[tuple[str, float]]:
    """Yield every number by its slot, in the unit of the screen."""
    window = seen.window
    for tension in layout.tensions:
        mean = window.mean_now(tension.channel) if window is not None else math.nan
        yield f"tension:{tension.channel}", mean
        yield f"reference:{tension.channel}", row.number(tension.reference or None)
    yield "speed", 60.0 * row.number(layout.speed or None)
    facts = seen.site
    channels = {roll.name: roll.radius_channel for roll in facts.rolls} if facts else {}
    for name, _ in layout.rolls:
        yield f"radius:{name}", 1e3 * row.number(channels.get(name))
    for output in facts.outputs if facts is not None else ():
        factor = 1e3 if output.unit == "m/s" else 1.0
        column = f"correction_{output.column}"
        now = factor * row.number(column)
        peak = abs(now)  # of an output that rests, what was before is not what goes out
        if not rests(row.state):
            peak = factor * (window.peak(column) if window is not None else math.nan)
        yield f"correction:{output.actuator}", now
        yield f"peak:{output.actuator}", peak
        limit = factor * output.limit
        yield f"share:{output.actuator}", peak / limit if limit > 0.0 else math.nan
        yield f"let_out:{output.actuator}", 100.0 * row.number(f"applied_ratio_{output.column}")
    yield from ripple_of(seen, row, layout)


def ripple_of(seen: Observed, row: TickRow, layout: Layout) -> Iterator[tuple[str, float]]:
    """Yield the numbers of ``values_of`` that are of ripple: as measured, and of the orders."""
    window, facts = seen.window, seen.site
    for tension in layout.tensions:
        yield f"rms:{tension.channel}", window.rms(tension.channel) if window else math.nan
    compared = row.state in GOES_OUT and not is_probing(seen)
    for output in facts.outputs if facts is not None else ():
        factor = 1e3 if unit_of_channel(output.signal) == "m/s" else 1.0
        yield from _ripple(row, output.actuator, factor, compared=compared)


def _ripple(
    row: TickRow, actuator: str, factor: float, *, compared: bool
) -> Iterator[tuple[str, float]]:
    """Yield the ripple of the followed orders, rms, now and, where ``compared``, without AFF.

    Sinusoids of other frequencies add by their squares: rms^2 = sum of a^2 / 2.
    """
    orders = _told_apart(row, [one for one in row.orders() if one.actuator == actuator])
    now = [order.ripple for order in orders if math.isfinite(order.ripple)]
    both = [o for o in orders if math.isfinite(o.ripple) and math.isfinite(o.ripple_before)]
    now_rms = math.sqrt(sum(a * a for a in now) / 2.0) if now else math.nan
    yield f"now:{actuator}", factor * now_rms
    if not compared or not both:
        return
    without = math.sqrt(sum(order.ripple_before**2 for order in both) / 2.0)
    left = math.sqrt(sum(order.ripple**2 for order in both) / 2.0)
    yield f"without:{actuator}", factor * without
    if without > 0.0 and left > 0.0:
        yield f"reduction:{actuator}", 20.0 * math.log10(left / without)


def _told_apart(row: TickRow, orders: list[OrderStatus]) -> list[OrderStatus]:
    """Return the orders without those that hear what a larger one hears already.

    A lock-in over two turns does not tell frequencies apart that differ by less than half of the
    slower roll's turn: there two orders show one and the same ripple.
    """
    kept: list[tuple[float, float]] = []
    orders_kept = []
    turns = {name: abs(row.roll(name).omega_rad_s) for name in {one.roll for one in orders}}
    for order in sorted(orders, key=lambda one: -_finite(one.ripple)):
        turn = turns[order.roll]
        frequency = order.order * turn
        if not _is_heard_already(frequency, turn, kept):
            kept.append((frequency, turn))
            orders_kept.append(order)
    return orders_kept


def _is_heard_already(frequency: float, turn: float, kept: list[tuple[float, float]]) -> bool:
    """Return whether a lock-in of this roll hears one of these (frequency, turn) of others."""
    for other, turn_of_it in kept:
        is_near = abs(frequency - other) * TURNS < min(turn, turn_of_it)
        if is_near and turn_of_it != turn:
            return True
    return False


def _notes(
    seen: Observed, row: TickRow, layout: Layout, values: dict[str, float | None], say: Say
) -> Iterator[tuple[str, str]]:
    """Yield what a number of the ripple means now, and why there is none."""
    orders = row.orders()
    for output in layout.outputs:
        of_it = [order for order in orders if order.actuator == output.actuator]
        slot = f"without:{output.actuator}"
        if not of_it:
            yield slot, say(N_("no order is followed"))
        elif is_probing(seen):
            yield slot, say(N_("not compared while the response is measured"))
        elif row.state not in GOES_OUT:
            yield slot, say(N_("nothing goes out: this is the ripple without AFF"))
        elif values.get(slot) is None:
            yield slot, say(N_("not known: the orders were not heard for two turns yet"))
        elif any(order.law == SHAPE for order in of_it):
            yield slot, say(N_("without: the law's estimate, of the orders that it follows"))
        else:
            yield slot, say(N_("without: as it was before arming, of the orders followed"))
    for output in layout.outputs:
        largest = N_("largest of ten seconds; let out by the guard:")
        now = N_("now; let out by the guard:")
        yield f"peak:{output.actuator}", say(now if rests(row.state) else largest)
    for tension in layout.tensions:
        slot = f"rms:{tension.channel}"
        if values.get(slot) is None:
            yield slot, say(N_("ten seconds without a hole are needed"))
        else:
            yield (
                slot,
                say(N_("measured, all that moves in {seconds} s")).format(seconds=round(WINDOW_S)),
            )


def _coming(meeting: ComingMeeting, say: Say) -> Coming:
    text = say(
        N_("{actuator}: {roll} {order}x meets {other} {other_order}x in {time}, at {radius}")
    ).format(
        actuator=printable(meeting.actuator, 60),
        roll=printable(meeting.roll, 60),
        order=meeting.order,
        other=printable(meeting.other_roll, 60),
        other_order=meeting.other_order,
        time=_duration(meeting.time_s),
        radius="{radius}",
    )
    return Coming(text=text, radius_mm=round(1e3 * meeting.radius_m))


def _duration(time_s: float) -> str:
    return f"{max(1, round(time_s / 10)) * 10} s" if time_s < 90.0 else f"{time_s / 60.0:.0f} min"


def _events(seen: Observed, say: Say) -> Iterator[Happened]:
    """Yield the newest events, those of one kind in a row as one."""
    for shown, (code, group) in enumerate(groupby(seen.events, lambda one: one[0])):
        if shown == SHOWN_EVENTS:
            return
        ages_s = [ago_s for _, _, ago_s in group]
        event = BY_CODE.get(code)
        name = event.name if event is not None else f"CODE {code}"
        times = f" ×{len(ages_s)}" if len(ages_s) > 1 else ""
        text = say(event.text) if event else ""
        yield Happened(name=name + times, text=text, ago_s=round(ages_s[0], 2))


def _finite(value: float) -> float:
    return value if math.isfinite(value) else 0.0
