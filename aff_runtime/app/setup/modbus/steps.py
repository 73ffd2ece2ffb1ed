"""The steps of `setup` that look at the PLC: table, heartbeat, quantities, angles, bits."""

from __future__ import annotations

import statistics
from collections.abc import Mapping

from aff_runtime.app.setup.asking.interview import YES_NO, owned_bits, quantity_value, roll_names
from aff_runtime.app.setup.asking.look import SKIP
from aff_runtime.app.setup.asking.plc import mean_si, readings_si
from aff_runtime.app.setup.asking.quantities import UNWIND, Quantity
from aff_runtime.app.setup.asking.questions import NONE, Question, one_of, whole
from aff_runtime.app.setup.modbus.display_steps import AGAIN, DisplaySteps
from aff_runtime.app.setup.words.angles import (
    LONGEST_S,
    AngleCandidate,
    angle_candidates,
    beside,
    doubt,
)
from aff_runtime.app.setup.words.behaviour import Behaviour, Kind, behaviours, heartbeats
from aff_runtime.app.setup.words.candidates import SHOWN_BEST
from aff_runtime.app.setup.words.reading import Watched, WordBlock
from aff_runtime.app.setup.words.status_bits import changed_bits
from aff_runtime.base.errors import ConfigError
from aff_runtime.base.units import plain

LOOK_S = 3.0  # for which all words are watched
BIT_S = 1.5  # for which they are watched before and after a state changes
SLOWEST_M_S = 0.02  # line speed below which no angle is looked for
WHOLE_TURNS = 3.0  # of a roll, to be seen before its angle is decided
AHEAD = 1.0  # of score, by which the first heartbeat has to be better than the second


class Steps(DisplaySteps):
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
        rivals = [one for one in candidates[1:] if one.score > candidates[0].score - AHEAD]
        unsure = "several words count up like a scan" if rivals else ""
        pick = self.pick("heartbeat", "Which is the PLC's heartbeat?", rows, unsure=unsure)
        best = candidates[int(pick) - 1]
        draft = self.dialogue.draft.with_answer("heartbeat", str(best.address))
        self.dialogue.keep(draft.with_answer("scan_ms", plain(float(f"{best.period_ms:.4g}"))))

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
            rows = self._angles(wanted, seen, behaviours(seen))[:SHOWN_BEST]
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
                    unsure=doubt(rows),
                )
                if pick != AGAIN and rows[int(pick) - 1].usable:
                    one = rows[int(pick) - 1]
                    self.keep_word(
                        wanted.channel,
                        one.decoding,
                        one.scale_text,
                        wraps_after=one.wraps_after,
                        unseen_s=one.unseen_s,
                    )
                    return
            else:
                self.dialogue.complain(
                    "  no word turns as this roll does at this line speed. Does it run?"
                )
            if not self.dialogue.is_patient:
                raise ConfigError(f"{wanted.channel}: no word of the window can be it")

    def _angles(
        self, wanted: Quantity, seen: Watched, does: Mapping[int, Behaviour]
    ) -> list[AngleCandidate]:
        """Return what can be this roll's angle; last what leaves no word for another roll."""
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

        That is so when ``WHOLE_TURNS`` were seen, and the best word has shown its end or
        is too slow to do so within ``LONGEST_S``.
        """
        if seen.duration_s < LOOK_S:
            return False
        does = behaviours(seen)
        rows = self._angles(wanted, seen, does)
        if not rows:
            return seen.duration_s > 2.0 * LOOK_S
        if rows[0].measured.turns < WHOLE_TURNS:
            return False
        moving = [does[place] for place in rows[0].decoding.addresses if does[place].rate_per_s]
        too_slow = all(65536.0 / abs(one.rate_per_s) > LONGEST_S for one in moving)
        return too_slow or any(one.wrap.seen for one in moving)

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
            unsure = "several bits changed with it" if len(rows) > 1 else ""
            pick = self.pick(f"{name}.pick", "Which one?", rows, AGAIN, NONE, unsure=unsure)
            if pick == AGAIN:
                continue
            one = changes[int(pick) - 1] if pick != NONE else None
            place = one.place if one else NONE
            self.dialogue.keep(self.dialogue.draft.with_answer(name, place))
            return

    def fits_one_read(self, block: WordBlock) -> bool:
        """Return whether the PLC gives all that is polled in one answer."""
        return self.patiently(lambda: self.reader.read(block.start, block.count)) is not None
