"""How every step stands: the last measurement counts, unless what it rests on has changed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import StrEnum

from aff_runtime.app.card.entries import UNKNOWN, Begun, CardEntry, Inputs, Measured, Signed
from aff_runtime.app.card.figures import Sample, Verdict
from aff_runtime.app.card.steps import STEPS, Basis, Step


class Stand(StrEnum):
    """How one step stands."""

    NOT_MEASURED = "not measured"
    OPEN = "open"
    AGAIN = "again"
    FAIL = "fail"
    PASS = "pass"
    NOT_APPLICABLE = "not applicable"


def is_finished(stand: str, *, is_signed: bool) -> bool:
    """Return whether nothing is left to do: passed or not applicable, and signed."""
    return stand in (Stand.PASS, Stand.NOT_APPLICABLE) and is_signed


_STAND_OF_VERDICT = {
    Verdict.PASS: Stand.PASS,
    Verdict.FAIL: Stand.FAIL,
    Verdict.OPEN: Stand.OPEN,
    Verdict.NOT_APPLICABLE: Stand.NOT_APPLICABLE,
}
SIGNABLE = (Stand.PASS, Stand.FAIL, Stand.NOT_APPLICABLE)


@dataclass(frozen=True, slots=True, kw_only=True)
class StepStanding:
    """One step.

    Attributes
    ----------
    why : what has changed since, in sentences, where it is to be done again.
    not_compared : what is known then or now alone, in sentences.
    last : entry of the measurement that counts; None without one.
    earlier : how many measurements were made before it.
    signature_entry : entry of the signature below ``last``; None without one.
    """

    step: Step
    stand: Stand
    why: tuple[str, ...] = ()
    not_compared: tuple[str, ...] = ()
    last: CardEntry | None = None
    earlier: int = 0
    signature_entry: CardEntry | None = None

    @property
    def measured(self) -> Measured | None:
        """What was measured last."""
        content = self.last.content if self.last is not None else None
        return content if isinstance(content, Measured) else None

    @property
    def signed(self) -> Signed | None:
        """The signature below it."""
        content = self.signature_entry.content if self.signature_entry is not None else None
        return content if isinstance(content, Signed) else None

    @property
    def is_finished(self) -> bool:
        """Whether nothing is left to do: passed or not applicable, and signed."""
        return is_finished(self.stand, is_signed=self.signed is not None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Card:
    """A whole card as it stands.

    Attributes
    ----------
    begun : what it is of. ``first`` : hash of that entry; no other card has it.
    newest : hash of the last entry. ``utc`` : when that entry was written.
    entry_count : how many entries the card has.
    """

    begun: Begun
    steps: tuple[StepStanding, ...]
    first: str
    newest: str
    entry_count: int
    utc: str

    @property
    def unfinished(self) -> tuple[StepStanding, ...]:
        """Steps that are not finished: of each something is left to do."""
        return tuple(one for one in self.steps if not one.is_finished)


def card_of(entries: Sequence[CardEntry], now: Inputs | None = None) -> Card:
    """Return how a card stands.

    Parameters
    ----------
    now : what holds now; None: it is not known, and nothing is compared.
    """
    begun = entries[0].content
    assert isinstance(begun, Begun)  # `entries_of` has seen to it
    return Card(
        begun=begun,
        steps=tuple(_standing(step, entries, now) for step in STEPS),
        first=entries[0].sha256,
        newest=entries[-1].sha256,
        entry_count=len(entries),
        utc=entries[-1].utc,
    )


def changed(step: Step, then: Inputs, now: Inputs) -> Iterator[str]:
    """Yield what has changed of what a step rests on.

    What is not known on one side is no change; a response that is on one side alone is one. A
    learned shape is none: the law saves it anew at each bypass, that of the proof among them.
    """
    for basis in step.rests_on:
        if basis is Basis.SITE:
            for what, old, new in _site_parts(step, then, now):
                if not _alike(old, new):
                    yield _was(what, old, new)
        elif basis is Basis.RESPONSES:
            for name, old, new in _responses(then, now):
                if UNKNOWN not in (old, new) and not _one_begins_the_other(old, new):
                    yield _was(f"{basis} of {name}", old, new)
        elif basis is Basis.MACHINE:
            if (
                then.machine
                and now.machine
                and not _one_begins_the_other(then.machine, now.machine)
            ):
                yield f"{basis}: {then.machine}, now {now.machine}"
        elif not _alike(*_pair(basis, then, now)):
            yield _was(basis, *_pair(basis, then, now))


def not_compared(step: Step, then: Inputs, now: Inputs) -> Iterator[str]:
    """Yield what a step rests on and is known on one side alone: nobody can say that it stayed."""
    for basis in step.rests_on:
        if basis is Basis.RESPONSES:
            for name, old, new in _responses(then, now):
                if UNKNOWN in (old, new):
                    yield f"{basis} of {name} not compared"
        elif basis is Basis.SITE:
            for what, old, new in _site_parts(step, then, now):
                if _is_one_sided(old, new):
                    yield f"{what} not compared"
        elif _is_one_sided(*_pair(basis, then, now)):
            yield f"{basis} not compared"


def _pair(basis: Basis, then: Inputs, now: Inputs) -> tuple[str, str]:
    pairs = {
        Basis.PLC: (then.plc, now.plc),
        Basis.ROLL: (then.roll_id, now.roll_id),
        Basis.MACHINE: (then.machine, now.machine),
    }
    return pairs[basis]


def _responses(then: Inputs, now: Inputs) -> Iterator[tuple[str, str, str]]:
    """Yield actuator and digest of its response then and now, empty where there was none."""
    for name in sorted({*then.responses, *now.responses}):
        yield name, then.responses.get(name, ""), now.responses.get(name, "")


def _site_parts(step: Step, then: Inputs, now: Inputs) -> Iterator[tuple[str, str, str]]:
    """Yield parts of the site file, then and now; where one side names none the whole file."""
    if not (then.parts and now.parts):
        yield Basis.SITE, then.site_hash, now.site_hash
        return
    for part in step.parts:
        yield f"{Basis.SITE}, {part}", then.parts.get(part.name, ""), now.parts.get(part.name, "")


def former_samples(step: Step, entries: Sequence[CardEntry], now: Inputs) -> tuple[Sample, ...]:
    """Return samples of a step that still count: nothing that it rests on has changed since.

    A learned response is what step 7 itself makes, so a new one takes none of them away.
    """
    samples: list[Sample] = []
    for entry in entries:
        content = entry.content
        if isinstance(content, Measured) and content.step == step.number:
            then = replace(content.inputs, responses=now.responses)
            same = not any(changed(step, then, now))
            samples = [*samples, *content.result.samples] if same else []
    return tuple(samples)


def newest_plc(entries: Sequence[CardEntry]) -> str:
    """Return the version of the PLC's program that was typed last, empty without one."""
    contents = (entry.content for entry in reversed(entries))
    return next((one.inputs.plc for one in contents if isinstance(one, Measured)), "")


def _standing(step: Step, entries: Sequence[CardEntry], now: Inputs | None) -> StepStanding:
    measurements = [
        entry
        for entry in entries
        if isinstance(entry.content, Measured) and entry.content.step == step.number
    ]
    if not measurements:
        return StepStanding(step=step, stand=Stand.NOT_MEASURED)
    last = measurements[-1]
    assert isinstance(last.content, Measured)
    then = last.content.inputs
    if not (then.machine or then.parts):  # of an older release: the card's first entry names it
        begun = entries[0].content
        then = replace(then, machine=begun.machine if isinstance(begun, Begun) else "")
    why = tuple(changed(step, then, now)) if now is not None else ()
    signature_entry = next(
        (
            entry
            for entry in reversed(entries)
            if isinstance(entry.content, Signed) and entry.content.measured == last.sha256
        ),
        None,
    )
    return StepStanding(
        step=step,
        stand=Stand.AGAIN if why else _STAND_OF_VERDICT[last.content.verdict],
        why=why,
        not_compared=tuple(not_compared(step, then, now)) if now is not None else (),
        last=last,
        earlier=len(measurements) - 1,
        signature_entry=signature_entry,
    )


def _alike(old: str, new: str) -> bool:
    """Return whether two are the same, as far as both are known."""
    return not old or not new or old == new


def _is_one_sided(old: str, new: str) -> bool:
    return bool(old) != bool(new)


def _one_begins_the_other(old: str, new: str) -> bool:
    """Return whether two texts may be of one thing.

    A record has the beginning of a digest alone, an older card that of a machine's name.
    """
    return old == new or bool(old and new and (old.startswith(new) or new.startswith(old)))


def _was(what: str, old: str, new: str) -> str:
    return f"{what}: {_short(old)}, now {_short(new)}"


def _short(digest: str) -> str:
    return digest[:12] or "none"
