"""The state per column of a shape law: one owner, one way to forget, one way to go on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Indices = npt.NDArray[np.int_]
Mask = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class ColumnMap:
    """Columns that both laws have: column ``mine[i]`` of the new one is ``theirs[i]`` of the old.

    Every part of the new law goes on from the old part's numbers there; what only the new one has
    keeps the numbers of a fresh start.
    """

    mine: Indices
    theirs: Indices

    def take(self, mine: npt.NDArray[np.generic], theirs: npt.NDArray[np.generic]) -> None:
        """Copy the common columns, which lie along the last axis."""
        mine[..., self.mine] = theirs[..., self.theirs]


def common(mine: Sequence[str], theirs: Sequence[str]) -> ColumnMap:
    """Return the columns of equal name."""
    at = {name: i for i, name in enumerate(theirs)}
    pairs = [(i, at[name]) for i, name in enumerate(mine) if name in at]
    both = np.array(pairs, dtype=np.int_).reshape(len(pairs), 2)
    return ColumnMap(mine=both[:, 0], theirs=both[:, 1])


class ColumnState:
    """Owns every array of a shape law that has one entry per column and outlives a tick.

    A part asks for its arrays once and writes into them, never over them. A live edit is then one
    ``adopt`` and a change of roll one ``forget``; a part cannot miss either.

    Parameters
    ----------
    count : number of columns.
    """

    __slots__ = ("_arrays", "_fresh", "_of_roll", "count")

    def __init__(self, count: int) -> None:
        self.count = count
        self._arrays: dict[str, npt.NDArray[Any]] = {}
        self._fresh: dict[str, complex] = {}
        self._of_roll: list[str] = []

    def array(
        self,
        name: str,
        fresh: complex = 0.0,
        *,
        dtype: npt.DTypeLike = np.float64,
        rows: int = 0,
        of_roll: bool = False,
    ) -> npt.NDArray[Any]:
        """Return a new array (count,), or (rows, count), filled with ``fresh``.

        Parameters
        ----------
        name : ``part.quantity``; equal names of two laws are the same quantity.
        of_roll : belongs to the roll that turns, so that ``forget`` sets it back to ``fresh``.

        Raises
        ------
        ValueError
            When the name is taken.
        """
        if name in self._arrays:
            raise ValueError(f"{name}: two parts keep it")
        shape = (rows, self.count) if rows else (self.count,)
        made = np.full(shape, fresh, dtype=dtype)
        self._arrays[name], self._fresh[name] = made, fresh
        if of_roll:
            self._of_roll.append(name)
        return made

    def forget(self, columns: Mask) -> None:
        """Set what belongs to the roll back to a fresh start in some columns."""
        for name in self._of_roll:
            self._arrays[name][..., columns] = self._fresh[name]

    def adopt(self, old: ColumnState, both: ColumnMap) -> None:
        """Go on with the numbers of ``old`` in the columns that both have."""
        for name, mine in self._arrays.items():
            if name in old._arrays:
                both.take(mine, old._arrays[name])
