"""What `sim-plant refine` says in words, as frozen records: it writes, a screen's job reads.

The names are those of the JSON in ``lacking.json`` and ``summary.json``. Sentences are English.
"""

from __future__ import annotations

from dataclasses import dataclass

VERSION = 1
SUMMARY, LACKING = "summary.json", "lacking.json"
KINDS = ("nothing", "traced", "set", "event", "unknown")
"""A verdict's answer in a word: ``set`` is *not identifiable*, ``event`` is *unknown* with nothing
left but what begins at a moment."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberSaid:
    """One number of an effect; ``low`` and ``high`` (95 %) are empty where it was assumed."""

    name: str
    value: str
    unit: str
    low: str
    high: str


@dataclass(frozen=True, slots=True, kw_only=True)
class EffectSaid:
    """One effect that was traced.

    Attributes
    ----------
    place : effect and where it is. ``text`` : what that is.
    can_cancel : whether a drive can cancel it. ``to_do`` : at the machine, to be rid of it.
    others : places that explain as much. ``experiments`` : what would tell them apart.
    """

    place: str
    text: str
    numbers: tuple[NumberSaid, ...]
    can_cancel: bool
    to_do: str
    others: tuple[str, ...]
    experiments: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ErrorSaid:
    """Error of a channel on the record judged, rms in ``unit``; ``floor``: of noise alone."""

    channel: str
    unit: str
    before: float
    after: float
    floor: float


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """A verdict in words.

    Attributes
    ----------
    kind : one of ``KINDS``. ``headline`` : what, where, how large.
    sure : how far it is ahead of what else might be. ``gain`` : before and after in a sentence.
    next_step : what the reader may do now.
    unknown : what no effect explains. ``limits`` : what these records cannot tell.
    judged_on : name of the record judged. ``held_out`` : no number was fitted to it.
    site_said : what was done with the site file, where one was given.
    """

    version: int = VERSION
    kind: str
    headline: str
    sure: str
    gain: str
    next_step: str
    effects: tuple[EffectSaid, ...]
    unknown: tuple[str, ...]
    errors: tuple[ErrorSaid, ...]
    limits: tuple[str, ...]
    judged_on: str
    held_out: bool
    site_said: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordLacks:
    """What one record lacks, before any work.

    Attributes
    ----------
    name : of the record. ``is_held`` : held out, to be judged on.
    refused : why it cannot be used; then nothing else is known of it.
    length_s : of the piece that is taken; ``radius_m`` : of the unwind roll when it begins.
    speed_m_s, tension_N : lowest and highest speed, and tension reference, in the piece.
    lacks : what cannot be claimed from it. ``said`` : what was found about it.
    """

    name: str
    is_held: bool
    refused: str = ""
    length_s: float = 0.0
    speed_m_s: tuple[float, float] = (0.0, 0.0)
    tension_N: tuple[float, float] = (0.0, 0.0)
    radius_m: float = 0.0
    lacks: tuple[str, ...] = ()
    said: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Lacking:
    """What records do not hold, and what cannot be claimed for that; ``together``: all of them."""

    version: int = VERSION
    records: tuple[RecordLacks, ...]
    together: tuple[str, ...]

    @property
    def can_begin(self) -> bool:
        """Whether every record can be used."""
        return bool(self.records) and not any(one.refused for one in self.records)
