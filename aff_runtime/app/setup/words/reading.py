"""Words of a PLC over some seconds, read with FC3 alone; nothing is ever written."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from aff_runtime.base.errors import WireError
from aff_runtime.base.ports import Clock
from aff_runtime.base.signals import Outcome
from aff_runtime.fieldbus.modbus.byte_stream import ByteStream
from aff_runtime.fieldbus.modbus.frames import ModbusFrames
from aff_runtime.fieldbus.modbus.probe_map import open_read_only
from aff_runtime.fieldbus.modbus.registers import MAX_READ_WORDS

PATIENCE_S = 3.0  # without an answer, until the PLC counts as gone
REPLY_S = 0.5  # for one answer
PAUSE_S = 0.02  # period of the readings
MOST_WORDS = 1000  # of a window
_LOOK_EVERY = 25  # readings, half a second of them, between two questions whether it is enough
_NO_SUCH_FUNCTION = 1  # exception codes of Modbus
_REFUSED = (2, 3)  # illegal address, illegal count


@dataclass(frozen=True, slots=True, kw_only=True)
class WordBlock:
    """Words at neighbouring addresses, which the PLC gives in one answer."""

    start: int
    count: int

    @property
    def addresses(self) -> range:
        """Return the wire addresses of its words."""
        return range(self.start, self.start + self.count)


@dataclass(frozen=True, slots=True, kw_only=True)
class Watched:
    """Words over time.

    Attributes
    ----------
    times_s : when each reading was complete, from the first on.
    words : the readings by wire address, as many as ``times_s``.
    """

    times_s: tuple[float, ...]
    words: Mapping[int, tuple[int, ...]]

    @property
    def duration_s(self) -> float:
        """Return the time from the first to the last reading, s."""
        return self.times_s[-1] - self.times_s[0] if self.times_s else 0.0


class WordReader:
    """Reads any words of one PLC on one connection, and only reads.

    Parameters
    ----------
    wire : not connected yet.
    device_id : unit identifier.
    clock : paces the readings.
    where : names the PLC in errors.
    """

    def __init__(self, wire: ByteStream, *, device_id: int, clock: Clock, where: str) -> None:
        self._device_id = device_id
        self._clock = clock
        self._where = where
        self._transport = open_read_only(
            device_id=device_id,
            read_start=0,
            read_count=1,
            clock=clock,
            wire=wire,
            patience_s=REPLY_S,
        )

    def close(self) -> None:
        """Release the connection."""
        self._transport.close()

    def read(self, start: int, count: int) -> list[int] | None:
        """Return ``count`` words from wire address ``start``; None when the PLC refuses them.

        Raises
        ------
        WireError
            The PLC does not answer for ``PATIENCE_S``, or cannot be asked this way.
        """
        frames = ModbusFrames(device_id=self._device_id, read_start=start, read_count=count)
        self._transport.ask_for(frames)
        give_up_ns = self._clock.now_ns() + round(PATIENCE_S * 1e9)
        why = "no reply"
        while self._clock.now_ns() < give_up_ns:
            deadline_ns = self._clock.now_ns() + round(REPLY_S * 1e9)
            outcome, words = self._transport.transact([], deadline_ns)
            if outcome is Outcome.OK:
                return words
            code = frames.last_exception_code if outcome is Outcome.EXCEPTION else 0
            if code in _REFUSED:
                return None
            if code == _NO_SUCH_FUNCTION:
                raise WireError(
                    f"{self._where}: does not know function 3 (exception 1). Let the PLC give its "
                    "words as holding registers."
                )
            why = f"exception {code}" if code else self._transport.trouble or why
            self._clock.sleep_until_ns(self._clock.now_ns() + round(PAUSE_S * 1e9))
        raise WireError(
            f"{self._where}: {why}. Check cable, address, port and device id; some PLCs take one "
            "client alone."
        )

    def survey(self, start: int, count: int) -> tuple[WordBlock, ...]:
        """Return which words of a window the PLC gives; what it refuses is halved and asked again.

        Raises
        ------
        WireError
            The PLC does not answer.
        """
        if count > MAX_READ_WORDS:
            rest = count - MAX_READ_WORDS
            head = self.survey(start, MAX_READ_WORDS)
            return head + self.survey(start + MAX_READ_WORDS, rest)
        if self.read(start, count) is not None:
            return (WordBlock(start=start, count=count),)
        if count == 1:
            return ()
        half = count // 2
        return self.survey(start, half) + self.survey(start + half, count - half)

    def watch(
        self,
        blocks: Sequence[WordBlock],
        seconds: float,
        enough: Callable[[Watched], bool] | None = None,
    ) -> Watched:
        """Read the blocks again and again for ``seconds``; less when ``enough`` says so.

        Raises
        ------
        WireError
            The PLC stopped answering, or refuses what it gave before.
        """
        times_s: list[float] = []
        words: dict[int, list[int]] = {}
        begin_ns = next_ns = self._clock.now_ns()
        while True:
            for block in blocks:
                given = self.read(block.start, block.count)
                if given is None:
                    raise WireError(f"{self._where}: now refuses words {block.start} and on")
                for place, word in enumerate(given, block.start):
                    words.setdefault(place, []).append(word)
            now_ns = self._clock.now_ns()
            times_s.append((now_ns - begin_ns) * 1e-9)
            next_ns += round(PAUSE_S * 1e9)
            over = now_ns - begin_ns >= seconds * 1e9
            if over or (enough is not None and len(times_s) % _LOOK_EVERY == 0):
                seen = Watched(
                    times_s=tuple(times_s),
                    words={place: tuple(series) for place, series in words.items()},
                )
                if over or (enough is not None and enough(seen)):
                    return seen
            self._clock.sleep_until_ns(next_ns)
            next_ns = max(next_ns, self._clock.now_ns())
