"""Which columns a changed law has in common with the one before it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Indices = npt.NDArray[np.int_]


@dataclass(frozen=True, slots=True)
class Common:
    """Columns that both laws have: column ``mine[i]`` of the new one is ``theirs[i]`` of the old.

    Every part of the new law goes on from the old part's numbers there; what only the new one has
    keeps the numbers of a fresh start.
    """

    mine: Indices
    theirs: Indices

    def take(self, mine: npt.NDArray[np.generic], theirs: npt.NDArray[np.generic]) -> None:
        """Copy the common columns, which lie along the last axis."""
        mine[..., self.mine] = theirs[..., self.theirs]


def common(mine: Sequence[str], theirs: Sequence[str]) -> Common:
    """Return the columns of equal name."""
    at = {name: i for i, name in enumerate(theirs)}
    pairs = [(i, at[name]) for i, name in enumerate(mine) if name in at]
    both = np.array(pairs, dtype=np.int_).reshape(len(pairs), 2)
    return Common(mine=both[:, 0], theirs=both[:, 1])
