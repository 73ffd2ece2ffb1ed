"""What one function asks of the whole translation that it belongs to."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

from sim_plant.codegen.kinds import Group, Kind
from sim_plant.codegen.sources import Source
from sim_plant.codegen.target import Target


@dataclass(frozen=True, slots=True, kw_only=True)
class Function:
    """One translated function: its C name, what it returns, all of its text."""

    c_name: str
    returns: Kind
    text: str


class Translation(Protocol):
    """All functions that the entries reach; see ``Program``."""

    target: Target
    structs: Mapping[str, type]

    def group(self, group: Group) -> None:
        """Have the C type of a group declared."""
        ...

    def writes(self, source: Source) -> bool:
        """Return whether a function, or one that it calls, writes to memory of its caller."""
        ...

    def function(self, source: Source, kinds: tuple[Kind, ...], masked: bool) -> Function:
        """Return a function for these arguments; ``masked``: for some of the lanes."""
        ...
