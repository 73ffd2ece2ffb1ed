"""Writes down what happens: the service's own events, and what changes between two looks."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from aff_hmi.notices import is_probing, why_it_rests
from aff_hmi.reason import MEANS
from aff_hmi.see.alarm import Alarm
from aff_hmi.see.events import KeptEvent, Kind, insert, newest, prune
from aff_hmi.see.store import Store
from aff_hmi.watch import News, Observed
from aff_hmi.wire_sentences import told
from aff_hmi.words import N_
from aff_runtime.app.door.messages import Facts
from aff_runtime.app.report.alarm_table import PRIORITIES
from aff_runtime.app.report.status_answer import OperatorNote
from aff_runtime.base.events import BY_CODE
from aff_runtime.base.ports import Clock
from aff_runtime.base.printable import printable
from aff_runtime.base.signals import State

STANDS_NS = 5_000_000_000  # that an order rests, before it is told
PRUNE_NS = 600_000_000_000  # between two looks for what is too old
MOST_AT_ONCE = 200  # entries from one look to the next
LONGEST = 200  # characters of a value
MISSED_NS = 60_000_000_000  # between two sentences about ticks that never happened
_S = 1e-9
NEEDED, ROLL_ID = ("time_s", "tick", "state"), "roll_id"
_TRIED_BY = re.compile(r" by (?P<who>.+)")
ROLL_EVENTS = ("SPLICE", "RADIUS_JUMP")


@dataclass(frozen=True, slots=True, kw_only=True)
class _Told:
    """What the facts said last, of which a change is an event."""

    config: str = ""
    differs: str = ""
    trying: bool = False
    probing: bool = False
    control_pid: int = 0
    recording: bool = True
    shapes: tuple[str, ...] = ()
    wire: tuple[str, ...] = ()


class Journal:
    """Follows one line and keeps its events in a store.

    Parameters
    ----------
    wall : returns wall time, s since 1970.

    Attributes
    ----------
    number : of the newest row that is kept; a page asks again when it changes.
    """

    def __init__(self, store: Store, clock: Clock, wall: Callable[[], float]) -> None:
        self._store = store
        self._clock = clock
        self._wall = wall
        self._new: list[KeptEvent] = []
        self._state: State | None = None
        self._roll_id = math.nan
        self._told: _Told | None = None
        self._heard: bool | None = None
        self._rests: dict[str, str] = {}
        self._since: dict[str, tuple[str, int]] = {}
        self._missed = math.nan
        self._missed_ns = 0
        self._stepped_s = 0.0
        self._operators: tuple[OperatorNote, ...] = ()
        self._pruned_ns: int | None = None
        self.number = store.now(newest)

    def add(self, kind: Kind, name: str, text: str, **more: str) -> None:
        """Write something down that happens now; ``who`` and values of the text by name."""
        who = printable(more.pop("who", ""), 60)
        values = {key: printable(value, LONGEST) for key, value in more.items()}
        self._write(
            KeptEvent(utc_s=self._wall(), kind=kind, name=name, text=text, values=values, who=who)
        )

    def first_out(self, alarm: Alarm, ring: str) -> None:
        """Write down what took the correction out, and what came with it; once for its tick."""
        led = alarm.led_by
        if led is None:
            name, tick, utc_s = alarm.condition.name, alarm.tick, alarm.since_s
            with_it = ", ".join(f"{one.name} {one.after_s:.3f} s" for one in alarm.followers)
        else:  # the alarm only followed it, and is not told to have done it
            name, tick, utc_s = led.name, led.tick, alarm.since_s - led.before_s
            with_it = f"{alarm.condition.name} {led.before_s:.3f} s"
        text = (
            N_("took the correction out; with it: {others}")
            if with_it
            else N_("took the correction out, alone")
        )
        self._write(
            KeptEvent(
                utc_s=utc_s,
                tick=tick,
                kind=Kind.ALARM,
                name=printable(name, 120),
                text=text,
                values={"others": printable(with_it, LONGEST)} if with_it else {},
                unique_key=f"{ring} {alarm.tick} first" if alarm.tick is not None else "",
            )
        )

    def listen(self, news: News) -> None:
        """Take what a poll of the ring has brought: events, states, rolls."""
        now_ns, now_s = self._clock.now_ns(), self._wall()
        for tick, t_ns, code, _ in news.events:
            self._write(_of_ring(news.ring, int(tick), now_s - (now_ns - t_ns) * _S, int(code)))
        if not len(news.records) or any(name not in news.columns for name in NEEDED):
            return
        at = {name: news.columns.index(name) for name in NEEDED}
        of_roll = news.columns.index(ROLL_ID) if ROLL_ID in news.columns else None
        rows = np.asarray(news.records)
        end_s = rows[-1][at["time_s"]]
        seen = rows[:, [at["state"], *([] if of_roll is None else [of_roll])]]
        known = [math.nan if self._state is None else self._state]
        before = np.vstack([[*known, *([] if of_roll is None else [self._roll_id])], seen[:-1]])
        for record in rows[(seen != before).any(axis=1)]:
            state = record[at["state"]]
            roll_id = self._roll_id if of_roll is None else record[of_roll]
            is_same = of_roll is None or roll_id == self._roll_id
            if state == self._state and is_same:
                continue
            utc_s = now_s - (end_s - record[at["time_s"]])
            self._write_all(self._changes(utc_s, int(record[at["tick"]]), int(state), roll_id))

    def look(self, seen: Observed) -> None:
        """Compare with the last look what the facts and the newest tick say; then keep it all."""
        self._hear(seen)
        self._clock_steps(seen.clock_step_s)
        if seen.facts is not None:
            self._compare(seen.facts)
        if seen.row is not None and seen.writer_lives:
            self._orders(seen)
            self._ticks(seen.row.number("missed_count"))
        self._keep()

    # --- what is written --------------------------------------------------------------------

    def _changes(self, utc_s: float, tick: int, code: int, roll_id: float) -> Iterator[KeptEvent]:
        state = State(code) if code in State._value2member_map_ else None
        if state is not self._state and state is not None:
            before = f"{self._state.name} → " if self._state is not None else ""
            text = MEANS[state.name]
            name = f"{before}{state.name}"
            yield KeptEvent(utc_s=utc_s, tick=tick, kind=Kind.STATE, name=name, text=text)
        if math.isfinite(self._roll_id) and math.isfinite(roll_id) and roll_id != self._roll_id:
            yield KeptEvent(
                utc_s=utc_s,
                tick=tick,
                kind=Kind.ROLL,
                name="ROLL",
                text=N_("another roll: number {number}"),
                values={"number": f"{roll_id:.0f}"},
            )
        self._state, self._roll_id = state, roll_id

    def _clock_steps(self, step_s: float) -> None:
        """Tell of a clock that was set; entries before it have the other time."""
        if step_s and step_s != self._stepped_s:
            text = N_("the gateway's clock was set by {seconds} s")
            self.add(Kind.SERVICE, "CLOCK", text, seconds=f"{step_s:+.1f}")
        self._stepped_s = step_s

    def _hear(self, seen: Observed) -> None:
        heard = seen.facts is not None and not seen.trouble
        if self._heard is not None and heard != self._heard:
            text = N_("the service is heard") if heard else N_("the service is not heard any more")
            self.add(Kind.SERVICE, "SERVICE", text)
        self._heard = heard

    def _compare(self, facts: Facts) -> None:
        status, before = facts.status, self._told
        recorder = status.recorder
        now = self._told = _Told(
            config=status.config_hash[:8],
            differs=next(iter(status.config_differs), ""),
            trying=bool(status.trying),
            probing=status.probing,
            control_pid=status.control_pid,
            recording=recorder is None or recorder.alive or not recorder.folder,
            shapes=status.shapes,
            wire=facts.wire,
        )
        self._consoles(status.operators)
        if before is None:
            return
        settings, service = Kind.SETTINGS, Kind.SERVICE
        if now.config != before.config:
            text = N_("other settings are in force: revision {after}, before {before}")
            self.add(settings, "SETTINGS", text, after=now.config, before=before.config)
        if now.differs != before.differs and now.differs:
            text = N_("the site file is not what runs: {why}")
            self.add(settings, "CONFIG_DIFFERS", text, why=now.differs)
        if now.trying != before.trying:
            text = N_("a try of other settings begins") if now.trying else N_("the try has ended")
            who = _TRIED_BY.search(status.trying)
            self.add(settings, "TRY", text, who=who["who"] if who is not None else "")
        if now.probing != before.probing:
            begins, ends = N_("the probe begins"), N_("the probe has ended")
            self.add(service, "PROBE", begins if now.probing else ends)
        if now.control_pid != before.control_pid:
            text = N_("the control process was started anew")
            ended = N_("the control process has ended; it comes back idle")
            self.add(service, "CONTROL", text if now.control_pid else ended)
        if now.recording != before.recording:
            text = N_("it is recorded again") if now.recording else N_("nothing is recorded")
            self.add(service, "RECORDER", text)
        for said in [one for one in now.shapes if one not in before.shapes]:
            self.add(Kind.ROLL, "SHAPE", "{said}", said=said)
        for said in [one for one in now.wire if one not in before.wire][:2]:
            what = told(said)
            self.add(service, what.name, what.trouble.text, **what.values)

    def _consoles(self, notes: tuple[OperatorNote, ...]) -> None:
        """Tell who commanded what on the console; also what came before this screen began."""
        for note in notes:
            if note in self._operators:
                continue
            self._write(
                KeptEvent(
                    utc_s=note.utc_s,
                    kind=Kind.PERSON,
                    name="CONSOLE",
                    text=N_("on the console: {did}"),
                    values={"did": printable(note.did, LONGEST)},
                    who=printable(note.who, 60),
                    unique_key=f"console {note.utc_s} {note.did}",
                )
            )
        self._operators = notes

    def _orders(self, seen: Observed) -> None:
        """Tell of orders that begin to rest, and of those that work again."""
        assert seen.row is not None
        if seen.row.state is not State.ACTIVE or is_probing(seen):
            self._since.clear()
            return
        now_ns = self._clock.now_ns()
        for order in seen.row.orders():
            key, why = f"{order.actuator}.{order.name}", why_it_rests(order)
            if why == self._rests.get(key, ""):
                self._since.pop(key, None)
                continue
            since = self._since.get(key)
            if since is None or since[0] != why:
                self._since[key] = (why, now_ns)
            elif now_ns - since[1] >= STANDS_NS:
                self._since.pop(key)
                self._rests[key] = why
                self._write(
                    KeptEvent(
                        utc_s=self._wall() - (now_ns - since[1]) * _S,
                        tick=int(seen.row.number("tick")),
                        kind=Kind.ROLL,
                        roll=printable(order.roll, 60),
                        name=printable(f"{order.actuator}: {order.name}", 120),
                        text=why or N_("works again"),
                    )
                )

    def _ticks(self, missed: float) -> None:
        """Tell of ticks that never happened, once a minute at most."""
        now_ns = self._clock.now_ns()
        if math.isnan(self._missed) or missed < self._missed:
            self._missed = missed
        if missed > self._missed and now_ns - self._missed_ns >= MISSED_NS:
            text = N_("{count} ticks did not happen")
            self.add(Kind.SERVICE, "TICKS", text, count=f"{missed - self._missed:.0f}")
            self._missed, self._missed_ns = missed, now_ns

    # --- the store --------------------------------------------------------------------------

    def _write(self, entry: KeptEvent) -> None:
        if len(self._new) < MOST_AT_ONCE:  # a flood costs its own tail
            self._new.append(entry)

    def _write_all(self, entries: Iterator[KeptEvent]) -> None:
        for entry in entries:
            self._write(entry)

    def _keep(self) -> None:
        now_ns, now_s = self._clock.now_ns(), self._wall()
        is_due = self._pruned_ns is None or now_ns - self._pruned_ns > PRUNE_NS
        if not self._new and not is_due:
            return
        entries, self._new = self._new, []
        store = self._store
        if is_due:
            self._pruned_ns = now_ns
            store.put(lambda c: prune(c, now_s, is_full=store.is_full(c)))

        def write(connection: object) -> None:
            insert(connection, entries)  # type: ignore[arg-type]
            self.number = newest(connection)  # type: ignore[arg-type]

        if entries:
            store.put(write)


def _of_ring(ring: str, tick: int, utc_s: float, code: int) -> KeptEvent:
    event = BY_CODE.get(code)
    name = event.name if event is not None else f"CODE {code}"
    kind = Kind.ALARM if name in PRIORITIES else Kind.STATE
    return KeptEvent(
        utc_s=utc_s,
        tick=tick,
        kind=Kind.ROLL if name in ROLL_EVENTS else kind,
        name=name,
        text=event.text if event is not None else "",
        unique_key=f"{ring} {tick} {code}",
    )
