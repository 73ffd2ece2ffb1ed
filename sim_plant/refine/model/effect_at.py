"""An effect with its location: what a search claims, a verdict names and a report says."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EffectAt:
    """One effect at one location, both by their names in a declaration."""

    effect: str
    location: str

    def __str__(self) -> str:
        """Return it as a version 1 verdict writes it."""
        return f"{self.effect} at {self.location}"

    @classmethod
    def parse(cls, text: str) -> EffectAt:
        """Return the effect and location that a version 1 verdict writes so.

        Raises
        ------
        ValueError
            When the text is no ``effect at location``.
        """
        effect, separator, location = text.partition(" at ")
        if not (effect and separator and location):
            raise ValueError(f"read {text!r}; expected an effect, ' at ' and a location")
        return cls(effect, location)
