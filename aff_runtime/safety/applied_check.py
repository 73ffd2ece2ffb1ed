"""Does the PLC add to the drive what we sent, and nothing else? Judged by what it shows."""

from __future__ import annotations

from collections.abc import Sequence
from math import isnan

from aff_runtime.base.signals import Outcome, Snapshot
from aff_runtime.safety.params import AppliedParams

_OK = Outcome.OK
_RING = 1024  # commands kept: 3 x 290 ms at 1 ms, the longest that a site file may ask for
_MASK = _RING - 1
SIGNS_TO_ACCUSE = 3  # readings, as with a foreign echo
_FORGOTTEN_AFTER_NS = 500_000_000  # since the last sign, so long that none counts any more


class _Output:
    """What is known of one correction.

    Attributes
    ----------
    sent : what was sent, by tick modulo ``_RING``.
    taken, low, high : of what was sent: the command that the PLC took, least and largest of all
        that it may show now.
    least, most : the same of what it took since the reading before, and a tick to either side.
    shown : the last reading that was taken in.
    level : the last reading that followed ours; a PLC that cuts at its limit stays there.
    cut_at : size at which ours was found cut, and nothing larger of ours since; 0: none.
    since_ns : since when the readings do not follow ours; None while they do, or are cut.
    known : there was a reading, and none has been missed since.
    """

    __slots__ = (
        "cut_at",
        "high",
        "known",
        "least",
        "level",
        "low",
        "most",
        "sent",
        "shown",
        "since_ns",
        "taken",
    )

    def __init__(self) -> None:
        self.sent = [0.0] * _RING
        self.taken = self.low = self.high = self.least = self.most = 0.0
        self.shown = self.level = self.cut_at = 0.0
        self.since_ns: int | None = None
        self.known = False

    def load_window(self, oldest: int, before: int, taken: int, newest: int) -> None:
        """Load what was sent in the ticks from ``oldest`` to ``newest``, and in those taken."""
        self.taken = self.sent[taken & _MASK]
        self.least, self.most = self._range(before - 1, min(taken + 1, newest))
        self.low, self.high = self._range(oldest, newest)

    def _range(self, first: int, last: int) -> tuple[float, float]:
        sent = self.sent
        low = high = sent[last & _MASK]
        for tick in range(first, last):
            value = sent[tick & _MASK]
            if value < low:
                low = value
            elif value > high:
                high = value
        return low, high

    def begins(self, shown: float, now_ns: int) -> None:
        """Take the first reading after a start or a gap: it may be anything.

        Smaller than ours and of its sign it may be ours, cut at the PLC's limit while nobody
        looked.
        """
        self.shown, self.since_ns, self.known = shown, now_ns, True
        if 0.0 < shown <= self.taken or self.taken <= shown < 0.0:
            self.cut_at = abs(shown)

    def judge_reading(self, shown: float, within: float, between_ns: float, now_ns: int) -> bool:
        """Take a reading in; return whether it is neither ours, nor zero, nor between the two."""
        before = self.shown
        if abs(shown) <= within:
            self.shown, self.since_ns = shown, now_ns
            return False
        if self.low - within <= shown <= self.high + within:
            if self._is_ours(shown, before, within):
                return False
        elif min(self.low, 0.0) - within <= shown <= max(self.high, 0.0) + within:
            again = self.since_ns is not None and abs(shown) > abs(before) + within
            if again:  # a ramp to zero never rises: ours is taken again, and cut
                self.level = shown
            self.shown = shown
            if again or self._at_level(shown, within):
                self.since_ns, self.cut_at = None, abs(shown)
                return False
        elif min(before, 0.0) - within <= shown <= max(before, 0.0) + within:
            self.shown, self.level = shown, 0.0  # larger than ours: nothing is cut
        else:
            return True
        if self.since_ns is None:
            self.since_ns = now_ns
        return now_ns - self.since_ns > between_ns

    def _is_ours(self, shown: float, before: float, within: float) -> bool:
        """Take in a reading that something of ours may be; return whether it counts as ours.

        One that stays while ours moves past it counts only where the PLC's limit may be.
        """
        moves = abs(shown - before) > within or self.high - self.low <= within
        if moves or abs(shown - self.taken) <= within:
            if self.least - within <= shown <= self.most + within:
                self.level = shown
                if abs(shown) > self.cut_at + within:
                    self.cut_at = 0.0  # the PLC's limit is beyond
            self.shown, self.since_ns = shown, None
            return True
        if self.since_ns is None and self._is_cut(shown, within):
            self.shown, self.cut_at = shown, abs(shown)
            return True
        if not min(self.least, 0.0) - within <= shown <= max(self.most, 0.0) + within:
            self.level = 0.0  # larger than what was taken: nothing is cut
        return False

    def _is_cut(self, shown: float, within: float) -> bool:
        """Return whether a reading is at the PLC's limit, and what was taken lies beyond."""
        beyond = self.taken >= shown if shown > 0.0 else self.taken <= shown
        return beyond and self._at_level(shown, within)

    def _at_level(self, shown: float, within: float) -> bool:
        """Return whether a reading is where the PLC's limit may be: it cuts both signs alike."""
        size = abs(shown)
        return abs(shown - self.level) <= within or abs(size - self.cut_at) <= within


class AppliedCheck:
    """Finds that the PLC applies a correction which is not ours. Never raises.

    ``aff_echo`` says which of our commands the PLC took in the scan of a reading. What it may show
    then, to within a count of both words:

    - what we sent, from the command of the reading before (less ``lag_ticks``, for a drive that
      is behind the PLC) to the newest;
    - zero: it may refuse us at any time;
    - between the two, or between zero and its last reading: it ramps to zero, for no longer than
      ``between_s``; or its own limit cuts ours, and it stays where it was when ours went beyond.

    A reading that stays while ours moves past it counts as between the two. Anything else is a
    sign of somebody else; three signs, never half a second apart, are an accusation, which ends
    half a second after the last sign. Only fresh data are judged; between them the last verdict
    stands. Signs under an echo that is not ours and stands still count when ours is back: an echo
    that moves is another runtime's, whom the echo's check names.
    The first reading after a start or a gap may be anything, and has ``between_s`` to become ours
    or zero; an echo that was not ours for a while is no gap, or anybody could make one.
    """

    def __init__(self, params: AppliedParams, outputs: int) -> None:
        self.params = params
        self._outputs = tuple(_Output() for _ in range(outputs))
        self._next: Sequence[float] = (0.0,) * outputs
        self._tick = 0
        self._echo_tick: int | None = None
        self._judged_ns = 0
        self._signs = self._held_back = 0
        self._sign_ns = self._other_ns = 0
        self._other: int | None = None
        self._found = (0, 0.0, 0.0, 0.0)

    def finding(self, names: Sequence[str]) -> str:
        """Return a sentence on what was found last: actuator, value applied, value sent."""
        index, shown, low, high = self._found
        unit = self.params.units[index] if index < len(self.params.units) else ""
        sent = f"{low:.3g}" if low == high else f"{low:.3g} to {high:.3g}"
        return f"{names[index]}: {shown:.3g} {unit} applied, {sent} sent"

    def note_sent(self, corrections: Sequence[float]) -> None:
        """Take what goes out in the next tick, SI per actuator."""
        self._next = corrections

    def judge(self, snapshot: Snapshot, now_ns: int) -> bool:
        """Return whether the PLC applies what is not ours; call it once a tick."""
        if not self.params.tolerances:
            return False
        self._note(snapshot.tick)
        if snapshot.applied and snapshot.fresh and snapshot.outcome is _OK:
            self._take(snapshot, now_ns)
        return self._signs >= SIGNS_TO_ACCUSE

    def _note(self, tick: int) -> None:
        """Keep what went out in this tick, and in those that ended before they came here."""
        missed = tick - self._tick
        self._tick = tick
        for back in range(min(missed, _RING) if missed > 0 else 1):
            at = (tick - back) & _MASK
            for output, value in zip(self._outputs, self._next, strict=False):
                output.sent[at] = value

    def _take(self, snapshot: Snapshot, now_ns: int) -> None:
        params, tick, age = self.params, snapshot.tick, snapshot.echo_age
        gap_ns, self._judged_ns = now_ns - self._judged_ns, now_ns
        if now_ns - self._sign_ns > _FORGOTTEN_AFTER_NS:
            self._signs = 0
        if gap_ns > params.gap_s * 1e9:
            self._echo_tick, self._held_back = None, 0
        before = self._echo_tick
        if not 0 <= age <= min(params.ticks, tick):
            self._take_other(snapshot, now_ns)
            return
        self._other = None
        self._echo_tick = tick - age
        first = self._echo_tick if before is None else min(before, self._echo_tick)
        if before is None:
            for output in self._outputs:
                output.known = False
        signs = self._held_back + self._is_sign(snapshot, first, self._echo_tick, now_ns)
        self._held_back = 0
        if signs:
            self._signs = min(self._signs + signs, SIGNS_TO_ACCUSE)
            self._sign_ns = now_ns

    def _take_other(self, snapshot: Snapshot, now_ns: int) -> None:
        """Hold back the signs under an echo that is not ours and stands still.

        One that moves, or stays for long, is another runtime's: the echo's check deals with it.
        """
        echo = snapshot.tick - snapshot.echo_age  # but for a constant
        stands_still = self._other == echo
        if self._other is None:
            self._other_ns = now_ns
        self._other = echo
        if now_ns - self._other_ns > self.params.gap_s * 1e9:
            self._echo_tick, self._held_back = None, 0
        if self._echo_tick is None or not stands_still:
            return
        if self._is_sign(snapshot, self._echo_tick, snapshot.tick, now_ns):
            self._held_back = min(self._held_back + 1, SIGNS_TO_ACCUSE)

    def _is_sign(self, snapshot: Snapshot, first: int, taken: int, now_ns: int) -> bool:
        """Return whether a reading shows what is not ours, with what was sent from ``first`` on.

        ``taken`` : tick of the command that the PLC took; the newest where nobody knows.
        """
        params, tick = self.params, snapshot.tick
        first = max(first, tick - _MASK + params.lag_ticks + 1)
        is_sign = False
        for index, (output, within, shown) in enumerate(
            zip(self._outputs, params.tolerances, snapshot.applied, strict=False)
        ):
            if within is None or isnan(shown):
                output.known = False
                continue
            output.load_window(first - params.lag_ticks, first, max(taken, first), tick)
            if not output.known:
                output.begins(shown, now_ns)
            if output.judge_reading(shown, within, params.between_s * 1e9, now_ns):
                if not is_sign:
                    self._found = (index, shown, output.low + 0.0, output.high + 0.0)  # no -0
                is_sign = True
        return is_sign
