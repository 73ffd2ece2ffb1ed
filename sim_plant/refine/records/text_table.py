"""CSV records, gzip or plain: columns of numbers under one line of names."""

from __future__ import annotations

import csv
import zlib
from array import array
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

import numpy as np

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable
from sim_plant.base.arrays import Array
from sim_plant.base.plain_file import text_stream
from sim_plant.refine.records.limits import LINE_CHARACTERS, UNPACKED_BYTES, check_size, path_text

_CELL_SHOWN = 60
"""Characters of a cell, and of a column's name, that an error quotes."""


def text_table(path: Path, payload: bytes) -> dict[str, Array]:
    """Return the columns of a CSV file by their headers; an empty cell is a missing value.

    The file goes through as a stream and every number takes 8 bytes, so what a record may hold
    is refused before it is held.

    Raises
    ------
    PlantError
        With file, line and column: truncated or no text, too large, fewer than two rows, a row of
        another length, a cell that is no number.
    """
    try:
        with text_stream(path, payload, UNPACKED_BYTES) as stream:
            return _columns(path, _lines(path, stream))
    except (OSError, EOFError, zlib.error, UnicodeDecodeError, csv.Error) as error:
        said = printable(str(error), 200)
        raise PlantError(f"{path_text(path)}: not a readable CSV file ({said})") from error


def number_table(path: Path, payload: bytes, columns: int) -> Array:
    """Return a table without a header (rows, columns), its numbers separated by blanks.

    Raises
    ------
    PlantError
        When it is none, has another number of columns, or too many rows.
    """
    values = array("d")
    try:
        with text_stream(path, payload, UNPACKED_BYTES) as stream:
            for number, line in enumerate(_lines(path, stream), start=1):
                cells = line.split()
                if len(cells) != columns:
                    raise PlantError(
                        f"{path_text(path)}: line {number} has {len(cells)} columns, "
                        f"declared are {columns}"
                    )
                values.extend(map(float, cells))
                check_size(path, columns, len(values))
    except (OSError, EOFError, zlib.error, ValueError) as error:
        said = printable(str(error), 200)
        raise PlantError(f"{path_text(path)}: not a table of numbers ({said})") from error
    return np.array(values).reshape(-1, columns)


def _columns(path: Path, lines: Iterator[str]) -> dict[str, Array]:
    first = next(lines, "")
    separator = max(",;\t", key=first.count)
    header = [h.strip() for h in next(csv.reader([first], delimiter=separator), [])]
    check_size(path, len(header), 0)
    values, number = array("d"), 1
    for number, cells in _rows(path, lines, separator):
        if len(cells) != len(header):
            raise PlantError(
                f"{path_text(path)}: "
                f"line {number}: {len(cells)} values under {len(header)} columns"
            )
        try:
            values.extend([float(cell) if cell.strip() else np.nan for cell in cells])
        except ValueError as error:
            raise PlantError(_no_number(path, number, header, cells)) from error
        check_size(path, len(header), len(values))
    if number < 3:
        held = "no rows" if number < 2 else "one row"
        raise PlantError(f"{path_text(path)}: holds {held}; a record needs two or more")
    if len(set(header)) < len(header):
        raise PlantError(f"{path_text(path)}: line 1: a column name appears twice")
    rows = np.array(values).reshape(-1, len(header))
    return {h: np.ascontiguousarray(rows[:, k]) for k, h in enumerate(header)}


def _rows(path: Path, lines: Iterator[str], separator: str) -> Iterator[tuple[int, list[str]]]:
    """Yield number and cells of every line from the second on; a row is one line.

    A quote that is left open would go on over all lines that follow, and every cell of them be
    held as a text before any is counted.
    """
    number = 1

    def one_at_a_time() -> Iterator[str]:
        for at, line in enumerate(lines, start=2):
            if at > number:
                raise PlantError(
                    f"{path_text(path)}: line {number}: a quote is left open; close it"
                )
            yield line

    rows = csv.reader(one_at_a_time(), delimiter=separator)
    while True:
        number += 1
        cells = next(rows, None)
        if cells is None:
            return
        yield number, cells


def _no_number(path: Path, number: int, header: list[str], cells: list[str]) -> str:
    """Return what is wrong in a row with a cell that is no number."""
    for name, cell in zip(header, cells, strict=True):
        try:
            float(cell.strip() or "nan")
        except ValueError:
            return (
                f"{path_text(path)}: line {number}: column {printable(name, _CELL_SHOWN)}: "
                f"read '{printable(cell, _CELL_SHOWN)}'; expected a number"
            )
    return f"{path_text(path)}: line {number}: holds no numbers"


def _lines(path: Path, stream: TextIO) -> Iterator[str]:
    """Yield lines without their ends, none longer than a header can be."""
    number = 0
    while line := stream.readline(LINE_CHARACTERS + 1):
        number += 1
        if len(line) > LINE_CHARACTERS:
            raise PlantError(
                f"{path_text(path)}: line {number} is longer than {LINE_CHARACTERS} characters"
            )
        yield line.removesuffix("\n")
