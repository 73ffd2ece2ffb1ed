"""The steps of `setup` that look at the PLC: table, heartbeat, quantities, angles, bits."""

from __future__ import annotations

import statistics
from collections.abc import Mapping, Sequence

from aff_runtime.app.setup.angles import (
    LONGEST_S,
    AngleCandidate,
    angle_candidates,
    beside,
    is_sure,
)
from aff_runtime.app.setup.behaviour import Behaviour, Kind, behaviours, heartbeats
from aff_runtime.app.setup.candidates import SHOWN_BEST, Candidate, Observation, candidates
from aff_runtime.app.setup.decoding import side_by_side
from aff_runtime.app.setup.display import is_place, shown_value
from aff_runtime.app.setup.floats import float_hints
from aff_runtime.app.setup.interview import YES_NO, owned_bits, quantity_value, roll_names
from aff_runtime.app.setup.look import SKIP, Look
from aff_runtime.app.setup.plc import mean_si, readings_si
from aff_runtime.app.setup.quantities import UNWIND, Quantity
from aff_runtime.app.setup.questions import NONE, AnswerError, Question, one_of, whole
from aff_runtime.app.setup.reading import Block, Watched
from aff_runtime.app.setup.status_bits import changed_bits
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.units import UnitError, plain

LOOK_S = 3.0
VALUE_S = 2.0
BIT_S = 1.5
SLOWEST_M_S = 0.02
WHOLE_TURNS = 3.0
AGAIN = "again"
NO_TENSION = (
    "Where a dancer stands is no tension: AFF takes ripple out of a tension that is measured. "
    "Type what a load cell between the unwind and the next driven roller shows; a line without "
    "one has nothing that AFF could listen to."
)


def _score(one: Candidate) -> float:
    return one.score


class Steps(Look):
    """What is found by looking, in the order in which it is asked."""

    def survey(self) -> None:
        """Find which words of the window the PLC gives, and show what they do."""
        answers = self.dialogue.draft.answers
        first, count = int(answers["first"]), int(answers["count"])
        if first + count > 65536:
            raise ConfigError(f"words {first} to {first + count - 1}: the last one is 65535")
        self.blocks = self.patiently(lambda: self.reader.survey(first, count))
        given = sum(block.count for block in self.blocks)
        if not given:
            raise ConfigError(
                f"the PLC refuses all words {first} to {first + count - 1}. Ask for others: "
                "`--again first --again count`."
            )
        refused = f"; it refuses the other {count - given}" if given < count else ""
        self.dialogue.say(f"the PLC gives {given} words{refused}")

    def table(self) -> Watched:
        """Watch all words and show what each does."""
        seen = self.watch(LOOK_S)
        for address, does in behaviours(seen).items():
            if does.kind is not Kind.STILL or does.last:
                self.dialogue.say(f"  word {address:5} = {does.last:5}  {does}")
        self.dialogue.say("  the others are still and 0")
        return seen

    def heartbeat(self) -> None:
        """Find the word that the PLC moves each scan."""
        kept = Question(name="heartbeat", text="Heartbeat", read=whole(0, 65535))
        if "heartbeat" in self.dialogue.draft.answers:
            self.dialogue.ask(kept)
            return
        candidates = heartbeats(self.table())
        if not candidates:
            raise ConfigError(
                "no word counts up each scan. AFF needs one: let the PLC add 1 to a word in every "
                "scan, then run setup again."
            )
        rows = {
            n: f"word {one.address}: {', '.join(one.why)}" for n, one in enumerate(candidates, 1)
        }
        pick = self.pick("heartbeat", "Which is the PLC's heartbeat?", rows)
        best = candidates[int(pick) - 1]
        draft = self.dialogue.draft.with_answer("heartbeat", str(best.address))
        self.dialogue.keep(draft.with_answer("scan_ms", plain(float(f"{best.period_ms:.4g}"))))

    def quantity(self, wanted: Quantity) -> None:
        """Find one quantity by what the display shows."""
        draft = self.dialogue.draft
        if self.is_known(wanted):
            return
        moments: list[Observation] = []
        while True:
            turn = str(len(moments) + 1) if moments else ""
            text = self._display(wanted, turn)
            if text == SKIP:
                self.dialogue.keep(draft.with_answer(f"{wanted.channel}.display", SKIP))
                return
            seen = self.watch(VALUE_S)
            moments.append(Observation(shown=shown_value(text, wanted.unit), seen=seen))
            for hint in float_hints(moments[-1].shown, seen, wanted.unit):
                self.dialogue.say(f"  {hint}")
            rows = candidates(
                moments,
                wanted.unit,
                signed=wanted.signed,
                moves=wanted.moves,
                taken=frozenset(self.dialogue.draft.owners),
                word_order=draft.order,
            )[:SHOWN_BEST]
            pick = self._of_candidates(wanted, rows, seen, turn)
            if pick is not None:
                self.keep_word(wanted.channel, pick.decoding, pick.scale_text)
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

    def _of_candidates(
        self, wanted: Quantity, rows: Sequence[Candidate], seen: Watched, turn: str
    ) -> Candidate | None:
        """Return what the technician picks; None to type another value."""
        shown = {}
        for n, one in enumerate(rows, 1):
            reads = f"{one.value:.5g} {wanted.unit} with scale {one.scale_text}"
            shown[n] = f"{one.decoding}: {reads}; {', '.join(one.why)}"
        for address in dict.fromkeys(one.decoding.address for one in rows[:3]):
            four = side_by_side(address, seen)
            said = "  ".join(f"{name} {count}" for name, count in four.items())
            self.dialogue.say(f"  word {address:5}: {said}")
        if not rows:
            self.dialogue.complain(
                "  no word fits. Type all digits that the display has, and the right unit."
            )
            if not self.dialogue.is_patient:
                raise ConfigError(f"{wanted.channel}: no word of the window fits what was typed")
            return None
        text = f"Which one? `{AGAIN}`: type the value at another moment, which decides more surely"
        pick = self.pick(
            f"{wanted.channel}.pick{turn}",
            text,
            shown,
            AGAIN,
            at={n: one.decoding.address for n, one in enumerate(rows, 1)},
            surely=rows[0].is_round and rows[0].score > max(rows[1:], key=_score).score + 1.0
            if rows[1:]
            else rows[0].is_round,
        )
        return None if pick == AGAIN else rows[int(pick) - 1]

    def angle(self, wanted: Quantity) -> None:
        """Find the encoder of a roll by its rate against line speed over radius."""
        if self.is_known(wanted):
            return
        question = Question(
            name=f"{wanted.channel}.display",
            text=f"Does the PLC show the {wanted.asked}, and does the line run now? yes, {SKIP}",
            read=one_of("yes", SKIP),
            default="yes",
        )
        while True:
            if self.dialogue.ask_anew(question) == SKIP:
                self.dialogue.keep(self.dialogue.draft.with_answer(question.name, SKIP))
                return
            self.dialogue.say(f"  watching, {LONGEST_S:g} s at most, until the count starts over")
            seen = self.watch(LONGEST_S, lambda seen: self._shows_all(wanted, seen))
            rows = self._angles(wanted, seen)[:SHOWN_BEST]
            shown = {
                n: f"{one.decoding}: {one.scale_text}; {', '.join(one.why)}"
                for n, one in enumerate(rows, 1)
            }
            if rows:
                pick = self.pick(
                    f"{wanted.channel}.pick",
                    "Which one?",
                    shown,
                    AGAIN,
                    at={n: one.decoding.address for n, one in enumerate(rows, 1)},
                    surely=is_sure(rows),
                )
                if pick != AGAIN and rows[int(pick) - 1].usable:
                    one = rows[int(pick) - 1]
                    self.keep_word(wanted.channel, one.decoding, one.scale_text)
                    return
            else:
                self.dialogue.complain(
                    "  no word turns as this roll does at this line speed. Does it run?"
                )
            if not self.dialogue.is_patient:
                raise ConfigError(f"{wanted.channel}: no word of the window can be it")

    def _angles(self, wanted: Quantity, seen: Watched) -> list[AngleCandidate]:
        """Return what can be this roll's angle, beside the rolls that are still looked for."""
        does = behaviours(seen)
        rows = self._angles_of(wanted.roll, seen, does)
        draft = self.dialogue.draft
        for roll in roll_names(draft):
            name = f"{roll}_angle_rad"
            if roll == wanted.roll or name in draft.words or f"{name}.display" in draft.answers:
                continue
            rows = beside(rows, self._angles_of(roll, seen, does), roll)
        return rows

    def _angles_of(
        self, roll: str, seen: Watched, does: Mapping[int, Behaviour]
    ) -> list[AngleCandidate]:
        draft = self.dialogue.draft
        speeds_m_s = readings_si(draft.words["line_speed_m_s"], "m/s", seen)
        if roll == UNWIND:
            radius_m = mean_si(draft.words["unwind_radius_m"], "m", seen)
        else:
            radius_m = quantity_value(draft, "second_radius", "m")
        if abs(statistics.fmean(speeds_m_s)) < SLOWEST_M_S or not radius_m > 0.0:
            return []
        return angle_candidates(
            seen,
            speeds_m_s=speeds_m_s,
            radius_m=radius_m,
            taken=frozenset(draft.owners),
            word_order=draft.order,
            does=does,
        )

    def _shows_all(self, wanted: Quantity, seen: Watched) -> bool:
        """Return whether longer watching shows no more.

        That is so when some whole turns were seen, and the best word has gone through its end or
        will not do so.
        """
        if seen.duration_s < LOOK_S:
            return False
        rows = self._angles(wanted, seen)
        does = behaviours(seen)
        if not rows:
            return seen.duration_s > 2.0 * LOOK_S
        if rows[0].measured.turns < WHOLE_TURNS:
            return False
        low = [does[place] for place in rows[0].decoding.addresses if does[place].rate_per_s]
        too_slow = all(65536.0 / abs(one.rate_per_s) > LONGEST_S for one in low)
        return too_slow or any(one.wraps or one.restarts_at for one in low)

    def find_bit(self, question: Question) -> None:
        """Find a status bit by changing its state."""
        name, ask_anew = question.name, self.dialogue.ask_anew
        while True:
            kept = self.dialogue.ask(question)
            if kept != "find":
                return
            now = ask_anew(
                Question(name=f"{name}.now", text="Is it so now? yes, no", read=one_of(*YES_NO))
            )
            before = self.watch(BIT_S)
            ask_anew(
                Question(
                    name=f"{name}.changed",
                    text="Change it (press, switch, stop), wait a second, then Enter",
                    read=lambda text: text or "done",
                    default="done",
                )
            )
            words = self.dialogue.draft.words.values()
            taken = frozenset(place for word in words for place in word.decoding.addresses)
            after = self.watch(BIT_S)
            changes = changed_bits(
                before,
                after,
                true_before=now == "yes",
                taken=taken,
                owned=frozenset(owned_bits(self.dialogue.draft, name)),
            )
            rows = {n: str(one) for n, one in enumerate(changes, 1)}
            pick = self.pick(f"{name}.pick", "Which one?", rows, AGAIN, NONE)
            if pick == AGAIN:
                continue
            one = changes[int(pick) - 1] if pick != NONE else None
            place = one.place if one else NONE
            self.dialogue.keep(self.dialogue.draft.with_answer(name, place))
            return

    def fits_one_read(self, block: Block) -> bool:
        """Return whether the PLC gives all that is polled in one answer."""
        return self.patiently(lambda: self.reader.read(block.start, block.count)) is not None
