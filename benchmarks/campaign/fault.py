"""One thing wrong with a machine, as it is drawn, written to a row and read again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from benchmarks.campaign import line as short

NAMES = [b[0] for b in short.BODIES]
IDLERS = [b[0] for b in short.BODIES if b[1] == "idler"]
DRIVES = [b[0] for b in short.BODIES if b[1] != "idler"]
CELLS = list(short.CELLS.values())
ALWAYS_S = -1.0
"""A moment before the record: what begins then is there all along."""
FOREVER_S = 1e6
"""After any record: what begins then is not there."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Fault:
    """One thing wrong with the machine.

    Attributes
    ----------
    effect : name in a verdict, or of something no library has.
    location : as in a verdict.
    size : strength, in the unit of its form.
    angle : phase, rad.
    shape : a further number: order, frequency, wavelength, profile (mode), radius of a nip.
    kind : class of the free line it makes for a library without it.
    form : which of the forms of its row.
    numbers : further numbers by name.
    from_s, from_b_s : moment of record a and of record b from which on it is there.
    """

    effect: str
    location: str
    size: float
    angle: float = 0.0
    shape: float = 0.0
    kind: str = ""
    form: str = ""
    numbers: tuple[tuple[str, float], ...] = ()
    from_s: float = ALWAYS_S
    from_b_s: float = ALWAYS_S

    @classmethod
    def read(cls, row: Mapping[str, Any]) -> Fault:
        """Return the fault that a row of the campaign holds."""
        numbers = tuple((str(name), float(value)) for name, value in row.get("numbers", ()))
        return cls(**{**row, "numbers": numbers})

    def number(self, name: str, default: float = 0.0) -> float:
        """Return a further number."""
        return dict(self.numbers).get(name, default)

    def in_record(self, which: str) -> Fault:
        """Return the fault as record ``a`` or ``b`` has it: ``from_s`` is of that record."""
        return self if which == "a" else replace(self, from_s=self.from_b_s)
