"""Writes what the plant measured and applied to a gzipped CSV, one row per sample."""

from __future__ import annotations

import gzip
from pathlib import Path
from typing import TextIO, cast

from aff_runtime.base.errors import PlantError
from sim_plant.servers.plant import Plant

_ROWS_PER_WRITE = 100


class PlantRecorder:
    """Observer of a plant; columns are ``time_s``, every output, then ``applied_<actuator>_m_s``.

    Raises
    ------
    PlantError
        The file cannot be written.
    """

    def __init__(self, path: Path, plant: Plant) -> None:
        try:
            stream = gzip.open(  # noqa: SIM115 (open for the life of the recorder)
                path, "wt", compresslevel=1, encoding="ascii", newline=""
            )
        except OSError as error:
            raise PlantError(f"cannot record to {path}: {error}") from error
        self._stream = cast(TextIO, stream)
        self._columns = tuple(plant.measured)
        self._rows: list[str] = []
        applied = (f"applied_{name}_m_s" for name in plant.applied_m_s)
        self._stream.write(",".join(("time_s", *self._columns, *applied)) + "\n")

    def take(self, plant: Plant) -> None:
        """Add the sample the plant has just finished."""
        values = [plant.measured[name] for name in self._columns]
        numbers = (plant.time_s, *values, *plant.applied_m_s.values())
        self._rows.append(",".join(f"{number:.9g}" for number in numbers))
        if len(self._rows) >= _ROWS_PER_WRITE:
            self._write()

    def close(self) -> None:
        """Write what is left."""
        self._write()
        self._stream.close()

    def _write(self) -> None:
        if self._rows:
            self._stream.write("\n".join(self._rows) + "\n")
            self._rows.clear()
