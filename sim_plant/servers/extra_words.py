"""Words of the PLC that are for the runtime's record alone: supplier of the roll, torques."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from sim_plant.base.ports import SteppedLine, TorqueReader

SUPPLIER = "unwind_supplier_number"
TORQUE = "_torque_N_m"
SUPPLIERS, SEED = 4, 19
"""From so many suppliers rolls come, one as often as another; seed of their sequence."""


class ExtraWords:
    """What a map may ask for beside what the line's sensors measure.

    Attributes
    ----------
    supplier : number of the supplier of the roll that is on; drawn anew with every roll.
    has_supplier : whether the map asks for it.
    """

    def __init__(self, line: SteppedLine, channels: Iterable[str]) -> None:
        self._line = line if isinstance(line, TorqueReader) else None
        self._draws = np.random.default_rng(SEED)
        self.new_roll()
        self.has_supplier = False
        self._drives: set[str] = set()
        self.ask_for(channels)

    def ask_for(self, channels: Iterable[str]) -> None:
        """Read from now on what of these channels are such words, too."""
        for name in channels:
            self.has_supplier = self.has_supplier or name == SUPPLIER
            if name.endswith(TORQUE):
                self._drives.add(name.removesuffix(TORQUE))

    def new_roll(self) -> None:
        """Draw the supplier of a roll that is put on."""
        self.supplier = int(self._draws.integers(1, SUPPLIERS, endpoint=True))

    def read(self) -> dict[str, float]:
        """Return the words that the map asks for, SI, as far as the line has them.

        Raises
        ------
        PlantError
            A roller whose torque is asked for has no drive.
        """
        words = {SUPPLIER: float(self.supplier)} if self.has_supplier else {}
        if self._line is not None:
            for drive in sorted(self._drives):
                words[drive + TORQUE] = self._line.torque_N_m(drive)
        return words
