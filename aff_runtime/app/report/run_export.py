"""A recorded run as one Parquet file: the columns of its rows, each with its unit."""

from __future__ import annotations

from pathlib import Path

from aff_runtime.app.report.parquet import Field, write_parquet
from aff_runtime.base.channel_units import unit_of_name
from aff_runtime.base.order_columns import RESPONSE_RATIO, is_part
from aff_runtime.base.printable import printable, text_or
from aff_runtime.base.probe_columns import PROGRESS
from aff_runtime.base.runs.files import yaml_values
from aff_runtime.base.runs.table import read_table
from aff_runtime.base.runs.window import RunWindow
from aff_runtime.base.yaml_section import Section

RATIOS = ("share", RESPONSE_RATIO)
OF_COLUMNS = (("_us", "us"), ("_mm", "mm"), ("_deg", "deg"))
"""Units that only columns of the service itself have, no channel."""
OF_SIGNAL = ("ripple", "ripple_before")
"""Parts of an order that are amplitudes in the signal of its actuator, in that one's unit."""


def export_run(window: RunWindow, path: Path) -> tuple[int, tuple[str, ...]]:
    """Write a window; return its number of rows and what the run has lost.

    Raises
    ------
    AffError
        It is no run, has no row there, or the file cannot be written.
    """
    table = read_table(window)
    site = _site(table.site_text)
    fields = [Field(name=name, unit=unit_of_column(name, site)) for name in table.columns]
    about = {
        "line": printable(text_or(table.about.get("name")), 100),
        "start_utc": printable(text_or(table.about.get("start_utc")), 40),
        "config_hash": printable(text_or(table.about.get("config_hash")), 64),
        "run": printable(str(window), 500),
    }
    write_parquet(path, fields, table.columns, about)
    return int(table.columns["time_s"].size), table.lost


def unit_of_column(name: str, site: Section | None = None) -> str:
    """Return the SI unit (or us, mm, deg) that the end of a column's name says.

    A ratio has the unit 1, a count or a word none. The ripple of an order has that of the signal
    which the run's site file gives its actuator.
    """
    last = name.rpartition(".")[2]
    if last in OF_SIGNAL and is_part(name, *OF_SIGNAL):
        actuator = (site or Section()).section("actuators").section(name.partition(".")[0])
        return unit_of_name(text_or(actuator.section("error").get("signal")))
    if last.startswith(("applied_ratio", "limit_ratio")) or last in RATIOS or name == PROGRESS:
        return "1"
    own = next((unit for end, unit in OF_COLUMNS if last.endswith(end)), "")
    return own or unit_of_name(last)


def _site(text: str) -> Section:
    try:
        return Section.of(yaml_values(text))
    except ValueError:
        return Section()
