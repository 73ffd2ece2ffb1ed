"""Control process and recorder as one unit: started, watched, restarted idle, stopped."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable

from aff_runtime.app.link.messages import Bypass, LogLine, Message, RingMade
from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.link.peer import own_process
from aff_runtime.app.report.status_answer import OperatorNote
from aff_runtime.app.report.tick_row import TickRow
from aff_runtime.app.supervisor.control_child import ControlChild, Ending
from aff_runtime.app.supervisor.recorder_child import RecorderChild
from aff_runtime.app.supervisor.recorder_losses import RecorderLosses
from aff_runtime.app.supervisor.response_ledger import ResponseLedger, learned_sentences
from aff_runtime.app.supervisor.restart_policy import RestartPolicy
from aff_runtime.app.supervisor.run_options import RunOptions
from aff_runtime.app.supervisor.shape_shelf import ShapeShelf
from aff_runtime.base.clock import wall_time_s
from aff_runtime.base.ports import Clock
from aff_runtime.base.printable import printable
from aff_runtime.base.runs.site_in_force import text_words
from aff_runtime.config.revision import SHORT
from aff_runtime.telemetry.recorder_messages import RecorderReport, RunContext
from aff_runtime.telemetry.ring import RingReader

STOP_PATIENCE_S = 3.0
RECORDER_PATIENCE_S = 5.0
START_PATIENCE_NS = 15_000_000_000
LATE = "ended by the service: no tick within 15 s of its start; free the machine of other work"
FRESH_S = 0.7  # an older tick says no more how the line stands
KEPT_OPERATORS = 8  # commands of the console that a screen is told of
DIED, STOPS, ANEW = (
    "the control process died",
    "the service stops",
    "the control process starts anew",
)
NO_ZERO = (
    "no answer of the PLC says that a zero arrived after the last correction; without our "
    "heartbeat it takes the correction away itself (see the line before it runs again)"
)
LOUD_NOTES = ("CONFIG_DIFFERS", "CONFIG_WARNING", "CONTROL_DIED")
LOG = logging.getLogger("aff_runtime")


class Processes:
    """The children of the supervisor.

    Parameters
    ----------
    on_change : called when there is another control process, or none any more.
    hear : takes what one that has ended had still said. ``on_end`` : called after that with why
        it is gone, while its record is still written.

    Attributes
    ----------
    parameters : parameter record that the control process runs on, or will be started with.
    control : None while there is no control process.
    ring : None until the control process has made one.
    blocked : the control process's sentence on what stands against an armed output.
    troubles : its sentences on what is wrong with the wire.
    gave_up : the control process died too often.
    restarts : how often one that had died was started anew.
    shapes : learned shapes, kept across starts.
    probed : which responses a probe of this service wrote.
    """

    def __init__(
        self,
        options: RunOptions,
        parameters: ParameterRecord,
        clock: Clock,
        *,
        on_change: Callable[[], None],
        hear: Callable[[Message], None],
        on_end: Callable[[str], None],
    ) -> None:
        self._options = options
        self._clock = clock
        self._policy = RestartPolicy()
        self._recorder: RecorderChild | None = None
        self._recorder_policy = RestartPolicy()
        self._recorder_lost = False
        self._losses = RecorderLosses()
        self._old_recorders: list[RecorderChild] = []
        self._restart_at_ns: int | None = None
        self._started_at_ns = 0
        self._on_change, self._hear, self._on_end = on_change, hear, on_end
        self.parameters = parameters
        self.control: ControlChild | None = None
        self.ring: RingReader | None = None
        self.blocked, self.also_blocking = "", tuple[str, ...]()
        self.operators = deque[OperatorNote](maxlen=KEPT_OPERATORS)
        self.troubles: tuple[str, ...] = ()
        self.gave_up = False
        self.restarts = 0
        self.bypassed_ns = 0
        self.shapes = ShapeShelf(self.note)
        self.probed = ResponseLedger(lambda text: self.note("RESPONSES", text))
        self._shape_texts: dict[str, str] = {}
        self._measured: dict[str, str] = {}  # newest response of the present record, by actuator
        self._started_by = str(own_process())

    def start(self) -> None:
        """Start the control process; its first messages say when there is a ring."""
        self._restart_at_ns = None
        self._started_at_ns = self._clock.now_ns()
        self.blocked, self.also_blocking = "", tuple[str, ...]()
        self.troubles = ()
        self._shape_texts = self.shapes.load(self.parameters)
        self.parameters = self.revised(self.parameters)
        try:
            parameters = self.parameters.starting_from(self._shape_texts)
            self.control = ControlChild(parameters, shadow=self._options.shadow)
        except OSError as error:
            LOG.error("the control process cannot be started (%s)", error.strerror)
            self._come_back()
            return
        self._on_change()
        LOG.info("control process %d started", self.control.pid)
        self.note_applied()

    def revised(self, parameters: ParameterRecord) -> ParameterRecord:
        """Return a record with the revision that it has with the shapes in use."""
        return parameters.with_shapes(self._shape_texts)

    def revision_words(self) -> str:
        """Return what runs: the whole revision, the site's, the learned files'."""
        whole, site = self.parameters.config_hash[:SHORT], self.parameters.site_hash[:SHORT]
        return (
            f"{whole}: site {site}; {'; '.join(learned_sentences(self.parameters, self.probed))}"
        )

    def stop(self, why: str = ANEW) -> Ending | None:
        """Let the control process fade and end, and the recorder flush in its own time.

        Return how it ended; None where there was none.
        """
        ending = None
        if self.control is not None:
            pid = self.control.pid
            ending = self.control.stop(patience_s=STOP_PATIENCE_S)
            if ending is Ending.BADLY:
                LOG.error("control process %d did not end in good order", pid)
            elif ending is Ending.UNHEARD:
                LOG.warning("%s", NO_ZERO)
            self._hear_last(self.control)
            self._forget_control(why)
        self._release_ring()
        return ending

    def finish(self) -> Ending | None:
        """Stop everything and wait for the recorders; return how the control process ended."""
        ending = self.stop(STOPS)
        for recorder in self._old_recorders:
            recorder.wait(RECORDER_PATIENCE_S)
        return ending

    def watch(self) -> bool:
        """Notice a death, restart when due; return True when the control process has died."""
        for recorder in [r for r in self._old_recorders if not r.report().alive]:
            recorder.wait(0.0)
            self._old_recorders.remove(recorder)
        due_ns = self._restart_at_ns
        if due_ns is not None and self._clock.now_ns() >= due_ns:
            self.restarts += 1
            self.start()
        self._look_after_recorder()
        if self.control is None:
            return False
        late = self.ring is None and self._clock.now_ns() > self._started_at_ns + START_PATIENCE_NS
        if late:
            self.control.kill()
        if (how := self.control.ended()) is None:
            return False
        self.note("CONTROL_DIED", f"control process {self.control.pid}: {LATE if late else how}")
        self._hear_last(self.control, level=logging.ERROR)
        self._forget_control(DIED)
        self._release_ring()
        self._come_back()
        return True

    def _hear_last(self, control: ControlChild, level: int = logging.WARNING) -> None:
        """Hand on what a control process that has ended had still said; its ring goes with it."""
        for message in control.replies():
            if isinstance(message, LogLine):
                LOG.log(level, "control: %s", message.text)
            elif not isinstance(message, RingMade):
                self._hear(message)

    def _look_after_recorder(self) -> None:
        """Let another recorder follow a ring whose recorder died; not for ever."""
        recorder, ring = self._recorder, self.ring
        if recorder is None or ring is None or self._recorder_lost:
            return
        report = recorder.report()
        if said := self._losses.step(report):
            LOG.warning("%s", said)
        if report.alive or not ring.writer_alive():
            return
        if self._recorder_policy.died(self._clock.now_ns() * 1e-9) is None:
            LOG.error("the recorder died three times within 60 s; nothing is recorded from now on")
            self._recorder_lost = True
            return
        LOG.error("the recorder died (%s); another one takes over", recorder.how_it_ended())
        recorder.wait(0.0)
        self._recorder = None
        self._start_recorder(ring, report.folder, recorder.how_it_ended())
        self.note_applied()  # the one that died may not have heard it: no event named the file
        for actuator, text in self._measured.items():
            self.keep_response(actuator, text)

    def _come_back(self) -> None:
        """Plan the next start of the control process, or give up."""
        pause_s = self._policy.died(self._clock.now_ns() * 1e-9)
        if pause_s is None:
            LOG.error("the control process died three times within 60 s; giving up")
            self.gave_up = True
        else:
            LOG.warning("control restarts idle in %.1f s; it needs an operator's arm", pause_s)
            self._restart_at_ns = self._clock.now_ns() + int(pause_s * 1e9)

    def take_ring(self) -> None:
        """Follow the ring that the control process has just made; begin a new record."""
        self._release_ring()
        self.ring = self.control.open_ring() if self.control is not None else None
        if self.ring is not None:
            self._recorder_lost = False
            self._measured.clear()
            self._start_recorder(self.ring)

    def _start_recorder(self, ring: RingReader, takes_over: str = "", died: str = "") -> None:
        """Begin a new record of ``ring``; the service goes on without one if need be.

        ``takes_over`` : the folder of a recorder that died, to go on in; ``died`` : how it did.
        """
        recording = self.parameters.site.recording
        directory = self._options.record_directory
        if directory is None:
            directory = self._options.site.absolute().parent / recording.directory
        context = RunContext(
            name=self.parameters.site.line.name,
            site_file=str(self._options.site.absolute()),
            started_by=self._started_by,
            site_hash=self.parameters.site_hash,
            learned=self.parameters.learned,
            max_MB=recording.max_MB,
            segment_s=recording.segment_s,
            wire_files=self.parameters.wire_digests,
            site_text=self.parameters.site_text,
            takes_over=takes_over,
            died=died,
        )
        try:
            self._recorder = RecorderChild(ring, directory, context)
        except OSError as error:
            LOG.error("nothing is recorded: the recorder cannot be started (%s)", error.strerror)

    def note(self, name: str, text: str) -> None:
        """Put a line into the log and into the record's events, foreign text made printable."""
        text = self._logged(name, text)
        if self._recorder is not None:
            self._recorder.note(name, text)

    def note_applied(self) -> None:
        """Say what runs from now on; the record gets its site file too."""
        runs = self.parameters
        words = self.revision_words() + text_words(runs.site_text)
        text = self._logged("CONFIG_APPLIED", words)
        if self._recorder is not None:
            self._recorder.note(
                "CONFIG_APPLIED", text, site_text=runs.site_text, site_hash=runs.site_hash
            )

    def keep_response(self, actuator: str, text: str) -> None:
        """Have the record keep a response that was measured, and the next one if this one dies."""
        self._measured[actuator] = text
        if self._recorder is not None:
            self._recorder.keep_response(actuator, text)

    def _logged(self, name: str, text: str) -> str:
        """Put a line into the log; return it as it stands there."""
        shown = printable(text)
        loud = name in LOUD_NOTES
        LOG.log(logging.WARNING if loud else logging.INFO, "%s: %s", name, shown)
        return shown

    def note_operator(self, did: str, who: str) -> None:
        """Put on record who commands what, and keep the last ones for who looks on."""
        self.note("OPERATOR", f"{did} by {who}")
        at_s = round(wall_time_s(), 3)
        self.operators.append(OperatorNote(utc_s=at_s, did=printable(did), who=printable(who)))

    def latest(self) -> TickRow | None:
        """Return the newest row of the ring, None while there is none."""
        row = self.ring.status() if self.ring is not None else None
        return None if row is None else TickRow(row)

    def age_s(self, tick: TickRow) -> float:
        """Return how old a row of the ring is, s; NaN where that is not known."""
        start_ns = self.ring.header.meta.start_ns if self.ring is not None else 0
        return tick.tick_age_s(start_ns, self._clock.now_ns())

    def fresh(self) -> TickRow | None:
        """Return the newest row, None where it is too old to say how the line stands."""
        latest = self.latest() if self.control is not None else None
        return latest if latest is not None and self.age_s(latest) < FRESH_S else None

    def recorder_report(self) -> RecorderReport | None:
        """Return what the recorder says of itself."""
        return self._recorder.report() if self._recorder is not None else None

    def is_live(self) -> bool:
        """Return whether a correction may be going out."""
        latest = self.latest()
        return latest is not None and latest.is_live

    def bypass(self) -> None:
        """Take the correction back, by link and by signal: one of them works."""
        self.bypassed_ns = self._clock.now_ns()
        if self.control is not None and self.control.ended() is None:
            self.control.link.send(Bypass())
            self.control.bypass_by_signal()

    def _forget_control(self, why: str) -> None:
        """Release the control process that has ended."""
        if self.control is not None:
            ended, self.control = self.control, None
            self._on_change()
            self._on_end(why)
            ended.close()

    def _release_ring(self) -> None:
        """Let go of the ring; its recorder ends by itself when everything is written."""
        if self.ring is not None:
            self.ring.close()
            self.ring = None
        if self._recorder is not None:
            self._old_recorders.append(self._recorder)
            self._recorder = None
