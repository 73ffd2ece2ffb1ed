"""MDF records (versions 2 to 4) as columns with units in their headers."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.arrays import Array
from sim_plant.refine.records.columns import Table, header_of, module_of_extra, numbers
from sim_plant.refine.records.limits import check_size, path_text
from sim_plant.refine.records.mdf_formulas import nothing_evaluated, refuse_formulas


def mdf_table(path: Path, payload: bytes) -> Table:
    """Return the channels of an MDF file on the stamps of the group with most, from 0 s on.

    A conversion that is a formula is code of whoever wrote the file, evaluated by a library: it
    is refused before a sample is read, wherever it sits. Logged bus frames are not decoded: that
    would read samples and a database inside the file on opening. Channels of other groups are
    interpolated linearly onto those stamps, which is said.

    Raises
    ------
    PlantError
        When it is not an MDF file, is too large, holds a formula or no channel, a channel holds
        no numbers, or another group covers another span of time or has stamps that go back.
    """
    package = module_of_extra(path, "asammdf", "asammdf")
    try:
        with (
            nothing_evaluated(path),
            package.MDF(
                io.BytesIO(payload), process_bus_logging=False, use_display_names=False
            ) as mdf,
        ):
            refuse_formulas(path, mdf)
            _check_sizes(path, mdf)
            signals = list(mdf.iter_channels(skip_master=True, copy_master=False))
    except (PlantError, MemoryError):
        raise
    except Exception as error:  # its own and those of broken blocks: struct, zlib, index, value
        said = printable(f"{type(error).__name__}: {error}", 200)
        raise PlantError(f"{path_text(path)}: not a readable MDF file ({said})") from error
    return _on_common_stamps(path, [s for s in signals if s.timestamps.size])


def _check_sizes(path: Path, mdf: Any) -> None:
    """Refuse by its headers a file whose samples, or whose rows of bytes, are too many."""
    columns = values = 0
    for group in mdf.groups:
        cycles, row_bytes = (
            int(group.channel_group.cycles_nr),
            int(group.channel_group.samples_byte_nr),
        )
        columns += len(group.channels)
        values += cycles * max(len(group.channels), -(-row_bytes // 8))
    check_size(path, columns, values)


def _on_common_stamps(path: Path, signals: list[Any]) -> Table:
    """Return all channels on the stamps of the group with most of them."""
    if not signals:
        raise PlantError(f"{path_text(path)}: holds no channel with values")
    master = max((s.timestamps for s in signals), key=lambda stamps: stamps.size)
    time_s: Array = np.asarray(master - master[0], dtype=np.float64)
    table, said = {"time_s": time_s}, []
    for signal in signals:
        values, name = numbers(path, signal.name, signal.samples), printable(signal.name, 60)
        if values.size != signal.timestamps.size:
            raise PlantError(
                f"{path_text(path)}: channel {name} has {values.size} values for "
                f"{signal.timestamps.size} stamps; export it anew"
            )
        if signal.invalidation_bits is not None:
            values = np.where(np.asarray(signal.invalidation_bits, dtype=bool), np.nan, values)
        if not np.array_equal(signal.timestamps, master):
            values = _on_stamps(path, signal, values, master)
            said.append(
                f"{name} has stamps of its own: interpolated onto those of the group with most"
            )
        table[header_of(path, table, signal.name, signal.unit)] = values
    return table, said


def _on_stamps(path: Path, signal: Any, values: Array, master: Array) -> Array:
    stamps = signal.timestamps
    if np.any(np.diff(stamps) <= 0.0):
        raise PlantError(
            f"{path_text(path)}: stamps of channel {printable(signal.name, 60)} stand still or go "
            "back; export it anew"
        )
    longest = float(np.max(np.diff(stamps), initial=0.0))
    if stamps[0] - master[0] > longest or master[-1] - stamps[-1] > longest:
        raise PlantError(
            f"{path_text(path)}: "
            f"channel {printable(signal.name, 60)} runs from {stamps[0]:.6g} s to "
            f"{stamps[-1]:.6g} s, others from {master[0]:.6g} s to {master[-1]:.6g} s; "
            "cut the record to what all have"
        )
    found: Array = np.interp(master, stamps, values)
    return found
