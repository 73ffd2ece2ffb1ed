"""The control process's side of everything around it: ring, link, signals, watchdog.

Implements ``loop.ports.OutsidePort``: every call returns at once. The link carries JSON; reading a
command costs some ten microseconds, reading a parameter record a millisecond, once per edit.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import replace

from aff_runtime.app.control.commands import CommandQueue
from aff_runtime.app.control.law_watch import LawWatch
from aff_runtime.app.control.probe_run import ProbeRun
from aff_runtime.app.control.shape_keeper import ShapeKeeper
from aff_runtime.app.control.trouble_log import TroubleLog
from aff_runtime.app.link import messages
from aff_runtime.app.link.packets import Link, LinkClosedError
from aff_runtime.app.link.replies import Reply
from aff_runtime.app.report.status import not_armed, refused_arm
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.wiring.assemble import Assembly, controller_of_record
from aff_runtime.app.wiring.law_slot import LawSlot
from aff_runtime.app.wiring.site_to_guard import guard_params
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import AffError, RefusedError
from aff_runtime.base.events import BY_NAME
from aff_runtime.base.ports import Clock, Law
from aff_runtime.base.printable import printable
from aff_runtime.base.signals import LATCHED_STATES, State
from aff_runtime.loop.messages import Arm, Bypass, Message, Shadow, Stop, SupervisorLost, Swap
from aff_runtime.loop.ports import Advice
from aff_runtime.loop.record import HEAD, record_columns
from aff_runtime.loop.watchdog import ServiceNotifier
from aff_runtime.safety.params import GuardParams
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.ring import RingWriter

TOO_LATE = "came after its time: who asked was told that nobody replied"
ARM_PATIENCE_TICKS = 100
ARM_LEAST_TICKS = 3
SHADOW_RETRY_TICKS = 100
ARMED = (State.ARMED, State.ACTIVE)
FRESH, ALARM, OUTCOME = (HEAD.index(name) for name in ("fresh", "alarm", "outcome"))
PLC_STALE = BY_NAME["PLC_STALE"].code
CONFIG_DIFFERS = BY_NAME["CONFIG_DIFFERS"].code


class ControlOutside:
    """What the cycle calls.

    Parameters
    ----------
    assembly : the rooms, wired.
    link : to the supervisor.
    meta : what a reader of the ring should know.
    clock : the one that the supervisor's questions are valid by.
    """

    def __init__(
        self, assembly: Assembly, link: Link, meta: RunMeta, clock: Clock | None = None
    ) -> None:
        self._site = assembly.site
        self._guard = assembly.guard
        self._law = assembly.law
        self._troubles = TroubleLog(assembly.gateway, self._of_rolls, self._say, self._show_wire)
        self._link = link
        self._commands = CommandQueue(link)
        self._meta = meta
        self._notifier = ServiceNotifier(
            {k: v for k, v in os.environ.items() if k == "NOTIFY_SOCKET"}
        )
        self._clock = clock or MonotonicClock()
        self._bypass_signal = False
        self._shadow_wanted = meta.shadow
        self._tick = 0
        self._record: Sequence[float] = ()
        self._ring_columns: tuple[str, ...] = ()
        self._arm_questions: dict[int, int] = {}  # the tick of each, by number
        self._arm_until_ns = 0  # an arm that waits for the first good reading, at most
        self._probe: ProbeRun | None = None
        self._next_law: LawSlot | None = None
        self._revision = assembly.parameters.config_hash
        self._watch = LawWatch(self._note, self._say)
        self._shapes = ShapeKeeper(
            assembly.parameters, tell=self._tell_shape, keep=self._keep_shape
        )
        self._advised_tick = 0
        self._ring = self._new_ring()

    def bypass_by_signal(self) -> None:
        """Take the correction back; called by a signal handler."""
        self._bypass_signal = True

    def close(self) -> None:
        """Hand on what was learned; the ring ends."""
        self._shapes.close(self._law.controller)
        self._ring.close()

    # --- what the cycle tells -----------------------------------------------------------------

    def publish(self, record: Sequence[float]) -> None:
        """Keep one record in the ring."""
        self._tick = int(record[1])
        self._record = record
        if self._next_law is not None and self._next_law.is_stepping:
            self._exchange_law(self._next_law)
        self._ring.write((*record, *self._law.law_telemetry()))
        self._troubles.follow(
            int(record[OUTCOME]),
            fresh=bool(record[FRESH]),
            latched=int(record[ALARM]) == PLC_STALE,
        )
        self._troubles.look(self._tick)
        first = len(HEAD)
        self._shapes.feed_trials(
            self._law.controller,
            record[first : first + len(self._site.gateway.read.channels)],
            fresh=bool(record[FRESH]),
            quiet=self._guard.quiet and self._law.probe is None,
        )

    def event(self, tick: int, t_ns: int, code: int) -> None:
        """Keep one event in the ring, and of a lost PLC log what came first."""
        self._ring.event(tick, t_ns, code)
        if code == PLC_STALE:
            self._troubles.stale()

    def fault_text(self, text: str) -> None:
        """Pass the traceback of an internal fault to the supervisor's log."""
        for line in text[-4000:].split("\n"):
            self._say(line)

    def blocked(self, reasons: tuple[str, ...]) -> None:
        """Tell the supervisor what stands against an armed output, for ``status``."""
        self._link.send(messages.Blocked.by(reasons))

    def adopt(self, settings: object) -> None:
        """Hand new settings to the guard."""
        if isinstance(settings, GuardParams):
            self._guard.adopt(settings)

    def advise(self, law: Law) -> Advice:
        """Return why the law's side would rather not arm, and whether ripple rose."""
        if self._probe is not None or not isinstance(law, LawSlot):
            return Advice()
        state, quiet = self._guard.state, self._guard.quiet
        elapsed_s = (self._tick - self._advised_tick) * self._site.cycle_s
        self._advised_tick = self._tick
        self._shapes.save_when_closed(
            law.controller,
            active=state is State.ACTIVE,
            quiet=quiet,
            unbelieved=self._watch.unbelieved,
            elapsed_s=elapsed_s,
        )
        return self._watch.advise(law, self._site, state=state, quiet=quiet, tick=self._tick)

    def tick_done(self, first_exchange_ok: bool) -> None:
        """Feed the watchdog of the service manager."""
        self._notifier.tick_done(first_exchange_ok)

    # --- what the cycle asks ------------------------------------------------------------------

    def poll(self) -> Sequence[Message]:
        """Return what the supervisor, a signal or the probe wants."""
        wanted: list[Message] = []
        if self._bypass_signal:
            self._bypass_signal = False
            self._arm_until_ns = 0
            wanted.append(Bypass())
            for overtaken in self._commands.overtake():
                self._reply(overtaken, ok=False, message="bypassed meanwhile")
        if self._shadow_wanted and self._tick % SHADOW_RETRY_TICKS == 0:
            self._shadow_wanted = self._guard.state is not State.SHADOW
            wanted.append(Shadow(on=True))  # again, until the PLC is there
        self._answer_arm()
        if self._probe is not None:
            wanted += self._watch_probe(self._probe)
        try:
            said = self._commands.next()
        except LinkClosedError:
            return (*wanted, SupervisorLost())
        if said is not None:
            try:
                wanted += self._obey(said)
            except (AffError, ValueError, KeyError, TypeError) as error:
                self._reply(said, ok=False, message=str(error))
        return wanted + self._arm_now()

    def _obey(self, said: messages.Message) -> list[Message]:
        """Return what one command means to the cycle."""
        for_cycle: list[Message] = []
        if isinstance(said, messages.Question) and self._clock.now_ns() > said.valid_until_ns:
            self._say(f"{type(said).__name__} {TOO_LATE}")
            raise RefusedError(TOO_LATE)
        match said:
            case messages.Arm():
                self._arm(said)
            case messages.Bypass():
                self._arm_until_ns = 0
                for_cycle = [Bypass()]
            case messages.Shadow():
                for_cycle = self._shadow(said)
            case messages.MeasureResponse():
                for_cycle = self._start_probe(said)
            case messages.Parameters():
                for_cycle = self._parameters(said)
            case messages.Stop():
                for_cycle = [Stop()]
            case messages.ConfigDiffers():
                self._note(CONFIG_DIFFERS)
            case messages.Forget():
                self._forget(said)
        return for_cycle

    def _arm(self, said: messages.Arm) -> None:
        """Take the operator's edge; the guard decides once there was a good reading.

        A control process that has just begun knows nothing of the PLC: the guard would refuse.
        """
        self._arm_questions[said.id] = self._tick
        self._arm_until_ns = said.valid_until_ns

    def _arm_now(self) -> list[Message]:
        if not self._arm_until_ns or not self._guard.has_connected:
            return []
        in_time = self._clock.now_ns() <= self._arm_until_ns
        self._arm_until_ns = 0
        return [Arm()] if in_time else []

    def _shadow(self, said: messages.Shadow) -> list[Message]:
        """Begin or end shadow operation."""
        self._shadow_wanted = False
        self._arm_until_ns = 0
        self._reply(said, ok=True)
        return [Shadow(on=said.on)]

    def _forget(self, said: messages.Forget) -> None:
        """Drop what was learned of rolls that are exchanged, or of those that are named."""
        unknown = [roll for roll in said.rolls if roll not in self._site.rolls]
        if unknown:
            there = ", ".join(self._site.rolls)
            self._reply(said, ok=False, message=f"no roll {unknown[0][:40]!a}; there are: {there}")
        elif not self._guard.quiet:
            self._reply(said, ok=False, message="a correction goes out; bypass first")
        else:
            forgotten = self._shapes.forget(self._law.controller, said.rolls)
            self._link.send(Reply(id=said.id, ok=True, rolls=tuple(sorted(forgotten))))

    def _answer_arm(self) -> None:
        """Reply to the operator once the guard has decided about the edge."""
        for ident, since in list(self._arm_questions.items()):
            self._answer_one_arm(ident, self._tick - since)

    def _answer_one_arm(self, ident: int, waited: int) -> None:
        state = self._guard.state
        message = ""
        if state not in ARMED:
            refused = waited > ARM_LEAST_TICKS and state not in LATCHED_STATES
            if not refused and waited <= ARM_PATIENCE_TICKS:
                return
            message = refused_arm(state, self._guard.first_blocking().removeprefix("blocked by "))
        ok = state in ARMED
        self._link.send(Reply(id=ident, ok=ok, message=message, state=state.name))
        del self._arm_questions[ident]
        self._arm_until_ns = self._arm_until_ns if self._arm_questions else 0

    # --- change of law ------------------------------------------------------------------------

    def _parameters(self, said: messages.Parameters) -> list[Message]:
        """Go on with another parameter record from the next tick."""
        if self._probe is not None:
            self._reply(said, ok=False, message="a probe is under way; save the file after it")
            return []
        parameters = said.record
        site = parameters.site
        present = self._law.controller
        successor = controller_of_record(parameters)
        law = LawSlot(successor, adopt_from=present)
        loses = set(present.telemetry_names()) - set(law.controller.telemetry_names())
        self._site = site
        self._shapes.follow(parameters)
        self._revision = parameters.config_hash
        self._meta = replace(self._meta, config_hash=self._revision)  # of the next ring
        self._next_law = law
        self._reply(said, ok=True)
        return [
            Swap(
                law=law,
                take_over=None if loses else _adopts_in_first_step,
                guard_params=guard_params(site),
                config_revision=parameters.revision_word,
            )
        ]

    def _start_probe(self, said: messages.MeasureResponse) -> list[Message]:
        """Put the probe in the law's place and arm for its duration."""
        if self._probe is not None:
            self._reply(said, ok=False, message="a probe is already under way")
            return []
        if self._next_law is not None:
            self._reply(said, ok=False, message="an edit is being applied; try again")
            return []
        if self._guard.state is State.SHADOW:
            self._reply(said, ok=False, message=not_armed(State.SHADOW, "SHADOW=1"))
            return []
        was_armed = self._guard.state in (*ARMED, State.FADING)
        self._probe = ProbeRun(
            self._site,
            said.actuators or tuple(self._site.actuators),
            was_armed=was_armed,
            config_hash=self._revision,
            version=self._meta.versions.get("aff-runtime", ""),
            former=self._law.controller.responses,
            params=self._law.controller.site,
            louder=said.louder,
        )
        law = LawSlot(self._law.controller, probe=self._probe.probe)
        self._next_law = law
        duration_s = self._probe.duration_s
        self._link.send(Reply(id=said.id, ok=True, duration_s=duration_s))
        return [Swap(law=law), Arm()]

    def _watch_probe(self, run: ProbeRun) -> list[Message]:
        """Return to the law when the probe has ended or cannot begin."""
        if not run.watch_tick(self._guard.state, self._tick):
            return []
        reason = run.failure(self._guard.state, self._guard.first_blocking())
        if reason:
            self._link.send(messages.Probed(error=reason))
        else:
            row = zip(self._ring_columns, self._record, strict=False)
            run.fit_in_child(self._link, TickRow(dict(row)))
        self._probe = None
        law = LawSlot(self._law.controller)
        self._next_law = law
        back: list[Message] = [] if run.was_armed else [Bypass()]
        return [*back, Swap(law=law)]

    def _exchange_law(self, law: LawSlot) -> None:
        """Follow the cycle to the law that it steps now; other columns need another ring."""
        before = self._law.law_telemetry_names()
        self._law, self._next_law = law, None
        if law.law_telemetry_names() != before:
            self._ring.close()
            self._ring = self._new_ring()

    def _new_ring(self) -> RingWriter:
        """Create the ring for the present columns and pass it to the supervisor."""
        outputs = [f"{name}_{_suffix(a.unit)}" for name, a in self._site.actuators.items()]
        columns = record_columns(tuple(self._site.gateway.read.channels), outputs, ())
        self._ring_columns = (*columns, *self._law.law_telemetry_names())
        ring = RingWriter(self._ring_columns, meta=self._meta)
        descriptor = ring.open_for_readers()
        self._link.send(messages.RingMade(rights=self._meta.rights), descriptor)
        os.close(descriptor)
        return ring

    def _note(self, code: int) -> None:
        """Keep an event of the present tick."""
        self._ring.event(self._tick, self._clock.now_ns(), code)

    def _say(self, text: str) -> None:
        """Pass a sentence to the supervisor's log, the wire's text in it made printable."""
        self._link.send(messages.LogLine(text=printable(text)))

    def _of_rolls(self) -> tuple[str, ...]:
        """Return what the law that runs now says of its rolls' radii and counts."""
        return self._law.controller.roll_notes()

    def _show_wire(self, troubles: tuple[str, ...]) -> None:
        """Tell the supervisor what is wrong with the wire, for ``status``."""
        self._link.send(messages.WireTroubles(troubles=troubles))

    def _tell_shape(self, actuator: str, text: str) -> None:
        """Tell the supervisor what became of a shape."""
        self._link.send(messages.ShapeNews(actuator=actuator, text=text))

    def _keep_shape(self, actuator: str, text: str) -> None:
        """Hand the supervisor a learned shape to be kept."""
        self._link.send(messages.ShapeLearned(actuator=actuator, file=text))

    def _reply(self, said: messages.Message, *, ok: bool, message: str = "") -> None:
        """Answer the supervisor, when it asked."""
        if isinstance(said, messages.Question):
            self._link.send(Reply(id=said.id, ok=ok, message=message))


def _adopts_in_first_step(old: Law) -> None:
    """Do nothing: the new ``LawSlot`` takes the old weights over in its own first step."""


def _suffix(unit: str) -> str:
    """Return a unit as the end of a column name."""
    return unit.replace("/", "_").replace(" ", "_")
