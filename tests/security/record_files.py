"""MDF files as a stranger could send them: formulas that make a folder when they are evaluated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from asammdf import MDF, Signal, Source
from asammdf.blocks import v2_v3_blocks, v4_blocks

v4c, v23c = v4_blocks.v4c, v2_v3_blocks.v23c
STAMPS = np.round(0.01 * np.arange(400), 4)
VALUES = 90.0 + np.sin(STAMPS)
CHANNEL, TIME = 1, 0
Change = Callable[[Any], None]


def touching(mark: Path) -> str:
    """Return a formula that makes the folder ``mark`` once numexpr's filter is off.

    asammdf turns x into X, so the letters of the name are written as octal numbers.
    """
    name = "".join(f"\\{ord(letter):03o}" for letter in str(mark))
    return f"X1 + (lambda: __import__('os').mkdir('{name}') or 0)()"


def algebraic(formula: str) -> Any:
    return v4_blocks.ChannelConversion(conversion_type=v4c.CONVERSION_TYPE_ALG, formula=formula)


def formula_3(formula: str) -> Any:
    return v2_v3_blocks.ChannelConversion(
        conversion_type=v23c.CONVERSION_TYPE_FORMULA, formula=formula
    )


def rational(**numbers: float) -> Any:
    return v4_blocks.ChannelConversion(conversion_type=v4c.CONVERSION_TYPE_RAT, **numbers)


def range_to(inner: Any, default: Any = b"") -> Any:
    """Return a table of ranges whose one entry, or whose default, is another conversion."""
    return v4_blocks.ChannelConversion(
        conversion_type=v4c.CONVERSION_TYPE_RTABX,
        links_nr=6,
        ref_param_nr=2,
        val_param_nr=2,
        lower_0=0.0,
        upper_0=200.0,
        text_0=inner,
        default_addr=default,
    )


def put(conversion: Any, channel: int = CHANNEL) -> Change:
    """Return a change that gives a channel of the first group this conversion."""

    def change(file: Any) -> None:
        file.groups[0].channels[channel].conversion = conversion

    return change


def logged_bus(conversion: Any) -> Change:
    """Return a change that adds logged CAN frames: asammdf reads them while it opens a file."""
    names = ("BusChannel", "ID", "DataLength", "DataBytes")
    kinds = ("u1", "<u4", "u1", "(8,)u1")
    types = [(f"CAN_DataFrame.{n}", k) for n, k in zip(names, kinds, strict=True)]

    def change(file: Any) -> None:
        frames = Signal(np.zeros(400, dtype=types), STAMPS, name="CAN_DataFrame")
        source = Source("CAN", "CAN", "", v4c.SOURCE_BUS, v4c.BUS_TYPE_CAN)
        file.append([frames], acq_source=source)
        group = file.groups[1]
        group.channel_group.flags |= v4c.FLAG_CG_BUS_EVENT
        group.channels[2].conversion = conversion

    return change


def saved(path: Path, version: str, *changes: Change, samples: Any = VALUES) -> Path:
    """Write one plain channel; each change works on the file before it is saved."""
    with MDF(version=version) as file:
        file.append([Signal(samples, STAMPS, name="unwind_tension_N")])
        for change in changes:
            change(file)
        return Path(file.save(path, overwrite=True))
