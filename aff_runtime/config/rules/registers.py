"""Registers: nothing overlaps, the blocks fit one request, every written word is ours."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise

from aff_runtime.config.findings import dotted
from aff_runtime.config.models import Site
from aff_runtime.config.registers import (
    LAST_ADDRESS,
    MAX_READ_WORDS,
    MAX_WRITE_WORDS,
    RegisterSpan,
    block_of,
    read_rows,
    write_rows,
)
from aff_runtime.config.rules.issue import Issue


def issues(site: Site) -> Iterator[Issue]:
    """Yield what is wrong with the register map."""
    modbus = site.gateway.modbus
    if modbus is None:
        return
    read, write = read_rows(site), write_rows(site)
    for row in (*read, *write):
        if not row.address >= 0 or row.last > LAST_ADDRESS:
            ends = "" if row.last == row.address else f"..{row.last}, the words of one value,"
            text = (
                f"wire address {row.address}{ends} does not exist (0..{LAST_ADDRESS}). Check the "
                "register and address_base."
            )
            yield Issue(path=row.path, text=text)
    yield from _overlaps([*read, *write])
    yield from _holes(write)
    yield from _base(site, [*read, *write])
    _, words = block_of(read)
    if words > MAX_READ_WORDS:
        yield _too_long(read, words, MAX_READ_WORDS, "read")
    _, words = block_of(write)
    function = modbus.function
    if words > MAX_WRITE_WORDS[function]:
        yield _too_long(write, words, MAX_WRITE_WORDS[function], "write")


def _overlaps(rows: list[RegisterSpan]) -> Iterator[Issue]:
    taken: dict[int, RegisterSpan] = {}
    for row in rows:
        for address in range(row.address, row.last + 1):
            other = taken.setdefault(address, row)
            if other is not row:
                text = (
                    f"wire address {address} is taken by {dotted(other.path[:-1])} "
                    f"({other.type}, {other.address}..{other.last}). Move one of the two."
                )
                yield Issue(path=row.path, text=text)
                break


def _holes(write: list[RegisterSpan]) -> Iterator[Issue]:
    for before, after in pairwise(write):
        gap = after.address - before.last - 1
        if gap > 0:
            text = (
                f"{gap} word(s) between {before.last} and {after.address} would be written but "
                f"are not ours. Move it to wire address {before.last + 1}."
            )
            yield Issue(path=after.path, text=text)


def _base(site: Site, rows: list[RegisterSpan]) -> Iterator[Issue]:
    if site.gateway.address_base == 0 and all(row.address >= 40001 for row in rows):
        text = "every register is above 40000. Where the manual calls the first 40001, write 1."
        yield Issue(path=("gateway", "address_base"), text=text, warning=True)


def _too_long(rows: list[RegisterSpan], words: int, limit: int, verb: str) -> Issue:
    text = (
        f"the {verb} block spans {words} words, {limit} fit one request. Bring the registers "
        "together."
    )
    return Issue(path=rows[-1].path, text=text)
