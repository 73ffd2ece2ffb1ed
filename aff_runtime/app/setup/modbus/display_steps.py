"""Finding a quantity by what its display shows, or by moving it where values do not decide."""

from __future__ import annotations

from collections.abc import Sequence

from aff_runtime.app.setup.asking.look import SKIP, Look
from aff_runtime.app.setup.asking.quantities import Quantity
from aff_runtime.app.setup.asking.questions import AnswerError, Question
from aff_runtime.app.setup.words.apart import (
    alike,
    first_moved,
    neighbours,
    without_halves,
    words_that_moved,
)
from aff_runtime.app.setup.words.candidates import SHOWN_BEST, Candidate, Observation, candidates
from aff_runtime.app.setup.words.decoding import side_by_side
from aff_runtime.app.setup.words.display import is_place, shown_value
from aff_runtime.app.setup.words.floats import float_hints
from aff_runtime.app.setup.words.reading import Watched
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.units import UnitError

VALUE_S = 2.0  # for which words are watched beside what was typed
REST_S = 5.0
"""How long words are watched at rest: some turns of a roll, whose ripple is no movement."""
MOVE_S = 45.0
"""How long somebody has to walk to a roller and move it."""
AGAIN, MOVE = "again", "move"
AT_REST = (
    "Leave the line as it shall be while you move it (running, or stopped with its web), then "
    "Enter"
)
MOST_NEAR = 3  # rows of words that nearly fit
NO_TENSION = (
    "Where a dancer stands is no tension: AFF takes ripple out of a tension that is measured. "
    "Type what a load cell between the unwind and the next driven roller shows; a line without "
    "one has nothing that AFF could listen to."
)


class DisplaySteps(Look):
    """One quantity after the other, by values that are typed and words that are watched."""

    def quantity(self, wanted: Quantity) -> None:
        """Find one quantity by what the display shows."""
        draft = self.dialogue.draft
        if self.is_known(wanted):
            return
        moments: list[Observation] = []
        asked, pick = 0, AGAIN
        while True:
            asked += 1
            turn = str(asked) if asked > 1 else ""
            if pick == AGAIN:
                text = self._display(wanted, turn)
                if text == SKIP:
                    self.dialogue.keep(draft.with_answer(f"{wanted.channel}.display", SKIP))
                    return
                moments.append(self._moment(wanted, text))
                offered = rows = self._rows(wanted, moments)
                self._side_by_side(rows, moments[-1].seen)
                unsure = _unsure(rows)
            else:
                offered, unsure = self._moved(wanted, rows, turn)
            if not rows:
                pick = self._no_word(wanted)
                continue
            pick = self._pick(wanted, offered, turn, unsure)
            if pick not in (AGAIN, MOVE):
                one = offered[int(pick) - 1]
                self.keep_word(wanted.channel, one.decoding, one.scale_text)
                return

    def _display(self, wanted: Quantity, turn: str) -> str:
        others = f", or {SKIP}" if wanted.optional else ""

        def read(text: str) -> str:
            if others and text == SKIP:
                return SKIP
            try:
                return shown_value(text, wanted.unit).text
            except UnitError as error:
                if wanted.unit == "N" and not wanted.recorded and is_place(text):
                    raise AnswerError(f"{error} {NO_TENSION}") from None
                raise

        return self.dialogue.ask_anew(
            Question(
                name=f"{wanted.channel}.display{turn}",
                text=f"What does the drive show now as {wanted.asked}, all digits and the unit"
                f"{others}?",
                read=read,
                default=SKIP if wanted.recorded else None,
            )
        )

    def _moment(self, wanted: Quantity, text: str) -> Observation:
        """Watch the words beside what was typed."""
        seen = self.watch(VALUE_S)
        moment = Observation(shown=shown_value(text, wanted.unit), seen=seen)
        for hint in float_hints(moment.shown, seen, wanted.unit):
            self.dialogue.say(f"  {hint}")
        return moment

    def _rows(self, wanted: Quantity, moments: Sequence[Observation]) -> list[Candidate]:
        """Return what fits what was typed, then words beside it that nearly do."""
        taken = frozenset(self.dialogue.draft.owners)
        rows = candidates(
            moments,
            wanted.unit,
            signed=wanted.signed,
            moves=wanted.moves,
            taken=taken,
            word_order=self.dialogue.draft.order,
        )
        near = []
        if rows and wanted.moves:
            near = neighbours(rows[0], rows, moments, taken=taken)[:MOST_NEAR]
        beside = {one.decoding for one in near}
        fitting = [one for one in rows if one.decoding not in beside]
        offered = without_halves([*fitting, *near])
        return [*[one for one in offered if one not in near][:SHOWN_BEST], *near]

    def _side_by_side(self, rows: Sequence[Candidate], seen: Watched) -> None:
        for address in dict.fromkeys(one.decoding.address for one in rows[:3]):
            four = side_by_side(address, seen)
            said = "  ".join(f"{name} {count}" for name, count in four.items())
            self.dialogue.say(f"  word {address:5}: {said}")

    def _no_word(self, wanted: Quantity) -> str:
        """Say that none fits; return what is done next."""
        self.dialogue.complain(
            "  no word fits. Type all digits that the display has, and the right unit."
        )
        if not self.dialogue.is_patient:
            raise ConfigError(f"{wanted.channel}: no word of the window fits what was typed")
        return AGAIN

    def _pick(self, wanted: Quantity, rows: Sequence[Candidate], turn: str, unsure: str) -> str:
        """Return the row that the technician takes, or what he does to know more."""
        shown = {}
        for n, one in enumerate(rows, 1):
            reads = f"{one.value:.5g} {wanted.unit} with scale {one.scale_text}"
            shown[n] = f"{one.decoding}: {reads}; {', '.join(one.why)}"
        text = f"Which one? `{AGAIN}`: type the value at another moment, which decides more surely"
        can_move = wanted.moves is not None
        if can_move:
            text += f"; `{MOVE}`: move it, and see which word follows"
        return self.pick(
            f"{wanted.channel}.pick{turn}",
            text,
            shown,
            AGAIN,
            *((MOVE,) if can_move else ()),
            at={n: one.decoding.address for n, one in enumerate(rows, 1)},
            unsure=unsure,
        )

    def _moved(
        self, wanted: Quantity, rows: Sequence[Candidate], turn: str
    ) -> tuple[list[Candidate], str]:
        """Let somebody move the quantity; return the rows, those of the word that moved first.

        The text is why row 1 still is not sure; empty where it is.
        """
        watched = alike(rows)
        rest, since = self._while_it_moves(wanted, watched, turn)
        found, first = first_moved(watched, rest, since)
        for one in found:
            self.dialogue.say(
                f"  word {one.candidate.decoding.address:5} changed by {one.change:.4g} "
                f"{wanted.unit}, at rest {one.swing:.4g}"
            )
        change_of = {one.candidate.decoding: one.change for one in found}
        offered = [
            one.because(f"changed by {change_of[one.decoding]:.4g} {wanted.unit}")
            if one in watched
            else one
            for one in rows
        ]
        if not first:
            others = set(words_that_moved(rest, since)) - {
                place for one in rows for place in one.decoding.addresses
            }
            self._nothing_moved(sorted(others), several=any(one.is_strong for one in found))
            return offered, "no row stood out when it was moved"
        best = {one.decoding for one in first}
        offered.sort(key=lambda one: one.decoding not in best)
        return offered, _unsure([one for one in offered if one.decoding in best])

    def _while_it_moves(
        self, wanted: Quantity, rows: Sequence[Candidate], turn: str
    ) -> tuple[Watched, Watched]:
        """Return the words at rest, and while somebody moves one thing."""
        self._wait(f"{wanted.channel}.rest{turn}", AT_REST)
        rest = self.watch(REST_S)
        self._wait(f"{wanted.channel}.move{turn}", how_to_move(wanted))
        return rest, self.watch(MOVE_S, lambda seen: bool(first_moved(rows, rest, seen)[1]))

    def _wait(self, name: str, text: str) -> None:
        read = Question(name=name, text=text, read=lambda text: text, default="done")
        self.dialogue.ask_anew(read)

    def _nothing_moved(self, others: Sequence[int], *, several: bool) -> None:
        if several:
            self.dialogue.complain("  several rows moved alike: move one thing alone")
        elif others:
            words = ", ".join(str(place) for place in others[:SHOWN_BEST])
            self.dialogue.complain(f"  no row moved; words that did: {words}")
        else:
            self.dialogue.complain("  no word moved further than at rest: move it more, or longer")


def how_to_move(wanted: Quantity) -> str:
    """Return what somebody is asked to move, and by what."""
    how = "change it at the drive"
    if wanted.unit == "N" and wanted.moves:
        how = (
            "at a stopped line press on the roller of its load cell, or lift its dancer; at a "
            "running one change the set point of its zone, which one on draw behind it follows"
        )
    what = f"{wanted.asked}; {how}"
    return f"Enter; then, within {MOVE_S:g} s, move this alone for some seconds: {what}"


def _unsure(rows: Sequence[Candidate]) -> str:
    """Return why row 1 is not taken unasked; empty where it is sure."""
    if not rows:
        return ""
    if not rows[0].is_round:
        return "the scale of row 1 is not round"
    same = alike(rows)
    if len(same) == 1:
        return ""
    numbers = ", ".join(str(n) for n, one in enumerate(rows, 1) if one in same)
    return f"rows {numbers} fit alike, and a wrong word in the loop moves the web"
