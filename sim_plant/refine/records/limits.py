"""How large a record may be: checked before a library multiplies it, and reported."""

from __future__ import annotations

from pathlib import Path

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable

FILE_BYTES = 512 << 20
"""The file itself; an hour at 1 kHz of 16 channels is 460 MB of plain numbers."""
UNPACKED_BYTES = 1 << 30
"""A text or Parquet file unpacked. Text is read as a stream and Parquet column by column, so this
bounds the time rather than the memory."""
VALUES = 50_000_000
"""Rows times columns; 400 MB as doubles, and refine holds them more than once."""
COLUMNS = 2_000
"""A logger of a whole plant has some hundred channels."""
NAME_CHARACTERS = 200
"""A channel's name with its path."""
LINE_CHARACTERS = 1 << 20
"""One line of a text file: all columns, each with a long name."""


def check_size(path: Path, columns: int, values: int) -> None:
    """Refuse a record with too many columns, or too many values in all of them.

    Raises
    ------
    PlantError
        With what was read and what is allowed.
    """
    if columns > COLUMNS:
        raise PlantError(
            f"{path_text(path)}: has {columns} columns, more than {COLUMNS}; "
            "export the channels that the line declares"
        )
    if values > VALUES:
        raise PlantError(
            f"{path_text(path)}: has {values} values or more, where {VALUES} are taken; "
            "cut the record, or export fewer channels"
        )


def check_name(path: Path, header: str) -> None:
    """Refuse a channel's name that is longer than any; PlantError with its start."""
    if len(header) > NAME_CHARACTERS:
        raise PlantError(
            f"{path_text(path)}: column {printable(header, 60)}: its name has {len(header)} "
            f"characters, more than {NAME_CHARACTERS}; export it with a short one"
        )


def path_text(path: Path) -> str:
    """Return a record's name as an error may say it."""
    return printable(str(path))
