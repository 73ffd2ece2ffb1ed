"""Records whose stamps are uneven: on the declared grid, and their readings as they came."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim_plant.base.arrays import Array
from sim_plant.base.plain_file import read_plain
from sim_plant.refine.records.in_child import table_from_child
from sim_plant.refine.records.limits import FILE_BYTES
from sim_plant.refine.records.read import TIME_NAMES, kind_of, si_name
from sim_plant.refine.records.recording import Recording
from sim_plant.refine.records.sanity import unwrapped
from sim_plant.refine.records.text_table import text_table

UNEVEN = "stamps are uneven"


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Stamped:
    """A record with the readings as they came.

    Attributes
    ----------
    record : on an even grid.
    time_s : stamps from the first (readings,); None where they are even.
    readings : channel -> values (readings,) at these stamps; empty where they are even.
    """

    record: Recording
    time_s: Array | None
    readings: dict[str, Array]


def on_declared_grid(record: Recording, sample_time_s: float) -> Stamped:
    """Return a record whose stamps are uneven on the declared grid; others as they are.

    The grid of another record has the same step then, and a tap of a filter is the same time in
    both. Straight lines between readings take noise away where a reading lies between two points
    of the grid, most at half the sample rate: errors are compared on one grid only.
    """
    if not any(text.startswith(UNEVEN) for text in record.findings):
        return Stamped(record=record, time_s=None, readings={})
    path, payload = record.path, read_plain(record.path, FILE_BYTES)
    kind = kind_of(path)
    raw = text_table(path, payload) if kind == "text" else table_from_child(path, kind, payload)[0]
    columns = {}
    for header, values in raw.items():
        name, factor = si_name(header, path)
        columns[name] = values * factor
    name = next(n for n in columns if n.lower().removesuffix("_s") in TIME_NAMES)
    time_s = columns.pop(name)
    time_s = time_s - time_s[0]  # they do not go back: `read_record` refuses such a record
    apart = time_s + 1e-9 * sample_time_s * np.arange(time_s.size)  # no two stamps alike
    readings, _ = unwrapped(columns)
    grid = sample_time_s * np.arange(int(time_s[-1] / sample_time_s * (1.0 + 1e-12)) + 1)
    off = float(np.max(np.abs(time_s - np.linspace(0.0, time_s[-1], time_s.size))))
    said = (
        f"{UNEVEN} by up to {off:.2g} s: put on the declared grid of {sample_time_s:.6g} s by "
        "straight lines, which take part of the noise near half the sample rate away"
    )
    even = replace(
        record,
        sample_time_s=sample_time_s,
        columns={n: np.interp(grid, apart, values) for n, values in readings.items()},
        findings=tuple(said if t.startswith(UNEVEN) else t for t in record.findings),
    )
    return Stamped(record=even, time_s=apart, readings=dict(readings))
