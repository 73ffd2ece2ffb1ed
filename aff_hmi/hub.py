"""Every browser that looks on: the newest frame to each, and never a queue."""

from __future__ import annotations

import asyncio
import contextlib
import secrets
from collections.abc import Callable, Iterator
from dataclasses import replace

from starlette.websockets import WebSocket, WebSocketDisconnect

from aff_hmi import frames
from aff_hmi.admission import admits
from aff_hmi.commission.link import Commission
from aff_hmi.counts import Counts
from aff_hmi.hand import Hand
from aff_hmi.layout import Layout, layout_of
from aff_hmi.machine import Machine
from aff_hmi.metrics import Metrics
from aff_hmi.see.kept import Kept
from aff_hmi.sources import Sources
from aff_hmi.view import view_of
from aff_hmi.viewer import Viewer
from aff_hmi.watch import Observed, Watch
from aff_hmi.words import say_in
from aff_runtime.app.report.metrics.readings import MetricHistogram, Sample
from aff_runtime.base.clock import wall_time_s
from aff_runtime.base.ports import Clock

FRAME_S = 0.1
QUIET_S = 0.6  # while nobody looks: the history has each second of it, with room for a late poll
LEAST_S = 0.02
MAX_SOCKETS = 32
MAX_IN_FLIGHT = 2
MAX_SAID_PER_S = 20
PATIENCE_S = 10.0
POLICY, TRY_LATER = 1008, 1013  # why a WebSocket is closed, as registered with IANA


class Hub:
    """Polls the watch and hands out frames.

    Parameters
    ----------
    watch : of the service.
    hand : None on a screen for looking only.
    kept : history, and the pages of it; None on a screen with the overview alone.
    commission : the way to the commissioner; None on a screen without one.
    machine : that the screen runs on; None: one without certificates.

    Attributes
    ----------
    boot : changes with every start; a page of an earlier one begins anew.
    counts : what the screen counts of itself.
    sources : of the pages beside the overview.
    """

    def __init__(
        self,
        watch: Watch,
        clock: Clock,
        hand: Hand | None = None,
        kept: Kept | None = None,
        commission: Commission | None = None,
        machine: Machine | None = None,
    ) -> None:
        self._watch = watch
        self._wall = kept.wall if kept is not None else wall_time_s
        self._machine = machine or Machine(clock, self._wall)
        self.commission = commission
        self.kept = kept
        self.hand = hand
        self._clock = clock
        self.counts = Counts()
        self.sources = Sources(kept, clock, self.counts, hand, self.metrics) if kept else None
        self._viewers: set[Viewer] = set()
        self._frames: dict[tuple[str, str], str] = {}
        self._metrics = Metrics(clock)
        self._number = 0
        self._ticked_ns: int | None = None
        self._due = asyncio.Event()
        self._layout_of: tuple[object, ...] = ()
        self.boot = secrets.token_hex(8)
        self.layout = Layout()

    async def run(self, alive: Callable[[], None] = lambda: None) -> None:
        """Poll for ever; a frame for those who look on every ``FRAME_S``, then ``alive``.

        Who comes gets one at once. While nobody looks the ring is read less often: a poll costs
        as much for one tick as for fifty. Until a tick was seen to arrive it is as if somebody
        looked: what is not known to be fresh, nobody may press. The first poll is at once: a page
        made before it would know of no line, and begin anew under the hands of who logs in.
        """
        due_ns = self._clock.now_ns()
        while True:
            self._watch.poll()
            if self.sources is not None:
                self.sources.listen(self._watch.news)
            if self.hand is not None:
                self.hand.desk.poll()
            self._machine.look()
            self.make_frames(
                replace(
                    self._watch.seen(),
                    clock_step_s=self._machine.clock_step_s,
                    certificate_s=self._machine.certificate_s,
                )
            )
            alive()
            is_quiet = not self._viewers and self._watch.hears_ticks
            period_ns = round(1e9 * (QUIET_S if is_quiet else FRAME_S))
            due_ns = await self._until(max(due_ns + period_ns, self._clock.now_ns()))

    async def _until(self, due_ns: int) -> int:
        """Wait until a frame is due, or somebody has come; return when it was due."""
        loop = asyncio.get_running_loop()
        timer = loop.call_later((due_ns - self._clock.now_ns()) * 1e-9, self._due.set)
        await self._due.wait()
        timer.cancel()
        if self._clock.now_ns() < due_ns:  # a flood of those who come costs no flood of frames
            await asyncio.sleep(LEAST_S)
        self._due.clear()
        return min(due_ns, self._clock.now_ns())

    def make_frames(self, seen: Observed) -> None:
        """Work out one frame per language that is looked at."""
        self._number += 1
        self._ticked_ns = _begun_ns(seen)
        self._lay_out(seen)
        if self.hand is not None:
            self.hand.look(seen, self._number)
        self.counts.sockets = len(self._viewers)
        if self.sources is not None:
            self.sources.look(seen, self.layout)
        is_loud = self.kept is not None and self.kept.book.is_loud
        standing = self.kept.book.standing if self.kept is not None else None
        heads = {
            language: frames.encode(
                view_of(seen, self.layout, say_in(language), standing),
                number=self._number,
                boot=self.boot,
                utc_s=self._wall(),
                is_loud=is_loud,
            )
            for language in {viewer.language for viewer in self._viewers}
        }
        self._frames = {
            (language, topic): self._with_part(heads[language], topic, language)
            for language, topic in {(viewer.language, viewer.topic) for viewer in self._viewers}
        }
        now_ns = self._clock.now_ns()
        for viewer in self._viewers:
            self._send(viewer, now_ns)

    def _lay_out(self, seen: Observed) -> None:
        """Work out the rows of the page again where facts or columns are other ones."""
        if seen.facts is None or seen.row is None or not seen.row.values:
            return
        of = (seen.facts.status.line, seen.site, tuple(seen.row.values))
        is_same = of == self._layout_of
        self._layout_of = of  # the same one the next time: then it need not be looked through
        if is_same:
            return
        layout = layout_of(seen.facts, tuple(channel.name for channel in seen.row.channels))
        if layout != self.layout:  # one that stays has its digest already
            self.layout = layout

    def _with_part(self, head: str, topic: str, language: str) -> str:
        if self.kept is None or topic not in self.kept.topics:
            return head
        return frames.with_part(head, self.kept.part(topic, language))

    def metrics(self) -> str:
        """Return what is seen now in the text format of Prometheus."""
        return self._metrics.text(self._watch.seen(), self._own_samples)

    def _own_samples(self) -> Iterator[Sample | MetricHistogram]:
        hand = self.hand
        yield from self.counts.samples(hand.sessions.by_role() if hand is not None else None)
        left_s = self._machine.certificate_s
        if left_s is not None:
            yield Sample("aff_hmi_certificate_seconds", (), left_s)
        if self.sources is not None:
            yield from self.sources.samples()

    async def serve(
        self,
        socket: WebSocket,
        language: str,
        own: Callable[[], str] = lambda: "",
        topic: str = "",
    ) -> None:
        """Look after one socket until it ends; ``topic`` : one of those that are kept."""
        address = socket.client.host if socket.client is not None else ""
        if not admits(address, (one.address for one in self._viewers), MAX_SOCKETS):
            await socket.close(TRY_LATER)
            return
        await socket.accept()
        viewer = Viewer(socket, language, address, own, topic)
        viewer.heard_ns = self._clock.now_ns()
        self._viewers.add(viewer)
        listening = viewer.listening = asyncio.create_task(self._listen(socket, viewer))
        try:
            await asyncio.wait([listening])
        finally:
            self._viewers.discard(viewer)
            listening.cancel()
            await asyncio.gather(listening, return_exceptions=True)
        with contextlib.suppress(RuntimeError, WebSocketDisconnect):
            await socket.close(POLICY)

    async def _listen(self, socket: WebSocket, viewer: Viewer) -> None:
        """Take receipts; who says anything else, or too much, is let go."""
        allowance, since_ns = float(MAX_SAID_PER_S), self._clock.now_ns()
        while True:
            message = await socket.receive()
            if message["type"] != "websocket.receive":
                return
            now_ns = self._clock.now_ns()
            refill = MAX_SAID_PER_S * (now_ns - since_ns) * 1e-9
            allowance, since_ns = min(MAX_SAID_PER_S, allowance + refill) - 1.0, now_ns
            said = frames.said_by(message.get("text") or "")
            if said is None or allowance < 0.0:
                return
            if viewer.echo_ms is None:
                self._due.set()
            viewer.heard(*said, now_ns)

    def _send(self, viewer: Viewer, now_ns: int) -> None:
        """Send the newest frame to who keeps up; let go of who has said nothing for long."""
        if now_ns - viewer.heard_ns > PATIENCE_S * 1e9:
            viewer.end()
            return
        if viewer.echo_ms is None:
            return
        has_room = len(viewer.in_flight) < MAX_IN_FLIGHT
        frame = self._frames[viewer.language, viewer.topic]
        if not (has_room and viewer.send(frames.opened(frame, viewer.echo_ms, viewer.own()))):
            self.counts.skipped += 1
            return
        self.counts.sent += 1
        viewer.in_flight.append(self._number)
        if self._ticked_ns is not None:
            self.counts.delays.add((self._clock.now_ns() - self._ticked_ns) * 1e-9)


def _begun_ns(seen: Observed) -> int | None:
    """Return when a tick began that has just arrived, in monotonic ns; None where none has."""
    is_new = seen.tick_age_s is not None and seen.tick_age_s < FRAME_S
    if not is_new or seen.row is None or seen.meta is None or not seen.meta.start_ns:
        return None
    return seen.meta.start_ns + round(seen.row.time_s * 1e9)
