"""The steps of `setup` on a bus: which signal is what, and what one count of it is."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

from aff_runtime.app.setup.asking.dialogue import Dialogue
from aff_runtime.app.setup.asking.draft import SENT, SIGNAL
from aff_runtime.app.setup.asking.interview import roll_names
from aff_runtime.app.setup.asking.look import SKIP
from aff_runtime.app.setup.asking.quantities import Quantity
from aff_runtime.app.setup.asking.questions import NONE, Question
from aff_runtime.app.setup.bus.heard import HeardSignal
from aff_runtime.app.setup.bus.questions import (
    SignalReader,
    scale_question,
    scales_from,
    scan_question,
)
from aff_runtime.app.setup.bus.ranking import Ranked, can_be, is_alone, is_likely, ranked
from aff_runtime.app.setup.bus.roles import Role, is_diameter, of_quantity
from aff_runtime.app.setup.words.display import shown_value
from aff_runtime.base.errors import ConfigError, WireError
from aff_runtime.base.units import plain, to_si, unit_info
from aff_runtime.fieldbus.can.named_signal import NamedSignal

SHOWN_ROWS = 8
Hear = Callable[[Sequence[NamedSignal]], Mapping[str, HeardSignal]]
ALIKE = "their names do not tell them apart, and a wrong signal in the loop moves the web"
NO_NAME = "no name says that it is this"


class BusSteps:
    """What every step needs.

    Parameters
    ----------
    dialogue : asks and keeps.
    signals : all that the files name.
    hear : returns what comes of some signals now; None where nobody listens.
    """

    def __init__(
        self, dialogue: Dialogue, signals: Sequence[NamedSignal], hear: Hear | None
    ) -> None:
        self.dialogue = dialogue
        self._signals = signals
        self._by_name = {one.name: one for one in signals}
        self._hear = hear

    def signal(self, role: Role) -> NamedSignal | None:
        """Return which signal is what ``role`` says; None where there is none.

        Raises
        ------
        ConfigError
            No signal of the files can be it, and the line cannot do without.
        """
        question_name = f"{SENT if role.written else SIGNAL}{role.name}"
        is_kept = question_name in self.dialogue.draft.answers
        heard = {} if is_kept else self._heard()
        moves = {name: one.moves for name, one in heard.items()}
        rows = ranked(role, self._signals, taken=self._taken(role), moves=moves)
        if not rows and not role.optional:
            raise ConfigError(
                f"{role.name}: no signal of the files can be the {role.asked}. {_wanted(role)}"
            )
        if not rows:
            self._keep(question_name, NONE)
            return None
        kept = self.dialogue.ask(self._question(question_name, role, rows, heard))
        return None if kept == NONE else self._by_name[kept]

    def heartbeat(self, role: Role) -> None:
        """Find the PLC's heartbeat, and the time of its scan."""
        signal = self.signal(role)
        measured = 0.0
        if signal is not None and "scan_ms" not in self.dialogue.draft.answers:
            shown = self._heard((signal,)).get(signal.name)
            measured = shown.period_ms if shown is not None else 0.0
        self.dialogue.ask(scan_question(measured))

    def quantity(self, wanted: Quantity) -> None:
        """Find a measured value, a set point or an angle, and what one count of it is."""
        signal = self.signal(of_quantity(wanted, roll_names(self.dialogue.draft)))
        if signal is not None:
            self._scale(wanted, signal)

    def correction_scale(self, name: str, signal: NamedSignal, ask: Question) -> None:
        """Keep what one count of a correction is: what the DBC says, else what is answered."""
        if signal.sent_to_us is None:  # a DBC file, which has a factor
            self._keep(name, plain(abs(signal.field.factor)))
        else:
            self.dialogue.ask(ask)

    def _keep(self, name: str, answer: str) -> None:
        if self.dialogue.draft.answers.get(name) != answer:
            self.dialogue.keep(self.dialogue.draft.with_answer(name, answer))

    def _taken(self, role: Role) -> dict[str, bool]:
        """Return what other roles have: whether each of these signals is written."""
        own = f"{SENT if role.written else SIGNAL}{role.name}"
        return {
            kept: name.startswith(SENT)
            for name, kept in self.dialogue.draft.answers.items()
            if name.startswith((SENT, SIGNAL)) and name != own and kept != NONE
        }

    def _heard(self, signals: Sequence[NamedSignal] = ()) -> Mapping[str, HeardSignal]:
        """Return what comes now; nothing where nobody listens, or the bus went away."""
        if self._hear is None:
            return {}
        try:
            return self._hear(signals or self._signals)
        except WireError as error:
            self.dialogue.complain(f"  {error}")
            return {}

    def _question(
        self, name: str, role: Role, rows: list[Ranked], heard: Mapping[str, HeardSignal]
    ) -> Question:
        shown = tuple(
            (str(n), _row(one.signal, heard.get(one.signal.name)))
            for n, one in enumerate(rows[:SHOWN_ROWS], 1)
        )
        default, unsure = _default(role, rows)
        reader = SignalReader(
            rows={str(n): one.signal.name for n, one in enumerate(rows[:SHOWN_ROWS], 1)},
            known=frozenset(one.signal.name for one in rows),
            why_not=lambda given: self._why_not(role, given),
            choices=(NONE,) if role.optional else (),
            unsure=unsure,
        )
        return Question(
            name=name, text=which_signal(role), read=reader, default=default, rows=shown
        )

    def _why_not(self, role: Role, name: str) -> str:
        """Return why a signal cannot be it; empty for one that there is not."""
        signal = self._by_name.get(name)
        if signal is None:
            return ""
        taken = self._taken(role)
        if name in taken:
            return "is something else already. Name another one."
        if not can_be(role, signal):
            return f"cannot be it: {_wanted(role)}"
        way = "sent" if role.written else "read"
        return f"is in {signal.layout.name}, which is not {way}: a frame has one sender."

    def _scale(self, wanted: Quantity, signal: NamedSignal) -> None:
        """Keep what one unit of the signal is: by the file's unit, else by display or manual."""
        name, half = f"{wanted.channel}.scale", wanted.unit == "m" and is_diameter(signal.called)
        info = unit_info(signal.unit) if signal.unit else None
        if info is not None:
            number = "0.5" if half else "1"
            unit = "" if to_si(info.symbol)[1] == 1.0 else f" {info.symbol}"
            self._keep(name, f"{number}{unit}")
            of = " of the radius, as it is a diameter" if half else ""
            self.dialogue.say(
                f"  {wanted.channel}: scale {number}{unit}{of}, by its unit in the file"
            )
            return
        rows: tuple[tuple[str, str], ...] = ()
        if wanted.unit != "rad" and name not in self.dialogue.draft.answers:
            rows = self._by_display(wanted, signal)
        self.dialogue.ask(scale_question(wanted.channel, wanted.unit, signal.name, rows))

    def _by_display(self, wanted: Quantity, signal: NamedSignal) -> tuple[tuple[str, str], ...]:
        """Return scales by which the signal shows what the display shows."""
        heard = self._heard((signal,)).get(signal.name)
        if heard is None or not _tells_scale(heard.value):
            return ()
        text = self.dialogue.ask_anew(
            Question(
                name=f"{wanted.channel}.display",
                text=f"What does the drive show now as {wanted.asked}, all digits and the unit, "
                f"or {SKIP}?",
                read=lambda typed: _read_display(typed, wanted.unit),
                default=SKIP,
            )
        )
        if text == SKIP:
            return ()
        now = self._heard((signal,)).get(signal.name, heard)
        if not _tells_scale(now.value):
            return ()
        return scales_from(shown_value(text, wanted.unit), now.value, wanted.unit)


def _tells_scale(value: float) -> bool:
    """Return whether a value beside a display says what one count is."""
    return math.isfinite(value) and value != 0.0


def which_signal(role: Role) -> str:
    """Return what is asked of a role."""
    way = "AFF sends" if role.written else "AFF reads"
    return f"Which signal, that {way}, is this: {role.asked}?"


def _read_display(text: str, unit: str) -> str:
    """Return a value off a display as it was typed; ``UnitError`` where it is none."""
    return text.strip() if text.strip() == SKIP else shown_value(text, unit).text


def _default(role: Role, rows: list[Ranked]) -> tuple[str | None, str]:
    """Return what an empty answer takes, and why it takes nothing."""
    if is_alone(rows):
        return rows[0].signal.name, ""
    if role.optional and not is_likely(rows):
        return NONE, ""
    return None, ALIKE if is_likely(rows) else NO_NAME


def _wanted(role: Role) -> str:
    """Return what a signal must be for a role."""
    if role.signed:
        return f"It needs a signed whole signal without offset, in {role.unit} or without a unit."
    if role.unit:
        return f"It needs a signal in {role.unit}, a unit of that kind, or without a unit."
    return (
        f"It needs whole counts without factor, offset and unit, {role.least_bits} bits or more."
    )


def _row(signal: NamedSignal, heard: HeardSignal | None) -> str:
    """Return a signal for eyes: message, factor, unit, range, and what comes of it."""
    field = signal.field
    kind = "float" if field.is_float else "signed" if field.signed else "unsigned"
    said = [f"{signal.name}: {field.length} bits {kind}"]
    if signal.sent_to_us is not None:
        said.append(f"called {signal.called}")
    if (field.factor, field.offset) != (1.0, 0.0):
        said.append(f"factor {plain(field.factor)}")
    if field.offset:
        said.append(f"offset {plain(field.offset)}")
    said.append(f"unit {signal.unit}" if signal.unit else "no unit")
    if field.minimum > float("-inf") or field.maximum < float("inf"):
        said.append(f"{plain(field.minimum)} to {plain(field.maximum)}")
    if heard is not None:
        said.append(
            f"now {plain(float(f'{heard.value:.6g}'))}, {'moves' if heard.moves else 'still'}"
        )
    return ", ".join(said)
