"""What a person does with an alarm of this screen, checked; written into the events."""

from __future__ import annotations

from collections.abc import Mapping

from aff_hmi.see.alarm_book import MOST_MINUTES, Refusal
from aff_hmi.see.events import Kind
from aff_hmi.see.kept import Kept
from aff_hmi.words import N_
from aff_runtime.base.printable import printable

LEAST_REASON, LONGEST_REASON = 4, 120
GONE_ALARM = N_("this alarm is not there any more")
TOO_HIGH = N_("an alarm of high priority is not put aside")
NO_REASON = N_("say why, in four characters or more")
WORDS = {Refusal.UNKNOWN: GONE_ALARM, Refusal.HIGH: TOO_HIGH}


class AlarmDesk:
    """Acknowledges and shelves; every method returns why not, in English, empty when it is done.

    Parameters
    ----------
    kept : whose book and journal they are.
    """

    def __init__(self, kept: Kept) -> None:
        self._kept = kept

    def seen(self, said: Mapping[str, str | int | bool], who: str) -> str:
        """Note that somebody has seen an alarm."""
        key = str(said["key"])
        refusal = self._kept.book.acknowledge(key, who)
        if refusal is None:
            self._write(N_("{alarm} was seen"), key, who)
        return "" if refusal is None else WORDS[refusal]

    def shelve(self, said: Mapping[str, str | int | bool], who: str) -> str:
        """Put an alarm aside with a reason, or take it back: minutes 0."""
        key, minutes = str(said["key"]), int(said["minutes"])
        reason = printable(str(said["reason"]).strip(), LONGEST_REASON)
        if minutes > 0 and len(reason) < LEAST_REASON:
            return NO_REASON
        refusal = self._kept.book.shelve(key, who, minutes, reason)
        if refusal is not None:
            return WORDS[refusal]
        if minutes > 0:
            text = N_("{alarm} was put aside for {minutes} min: {reason}")
            shown = str(min(minutes, MOST_MINUTES))
            self._write(text, key, who, minutes=shown, reason=reason)
        else:
            self._write(N_("{alarm} was taken back"), key, who)
        return ""

    def _write(self, text: str, key: str, who: str, **values: str) -> None:
        self._kept.journal.add(Kind.ALARM, "ALARM", text, who=who, alarm=key, **values)
