"""Reading a file that somebody else made: regular, of bounded size, as it is or unpacked."""

from __future__ import annotations

import gzip
import io
import os
import stat
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, TextIO, cast

from aff_runtime.base.errors import PlantError
from aff_runtime.base.printable import printable

if TYPE_CHECKING:
    from _typeshed import WriteableBuffer

_CHUNK_BYTES = 1 << 20
_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISSOCK, "a socket"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
)


def read_plain(path: Path, longest_bytes: int) -> bytes:
    """Return what a regular file holds; a link to one is followed.

    A pipe or a device could wait or go on for ever: what is no regular file is not even opened,
    and the open file is asked again.

    Raises
    ------
    PlantError
        It cannot be read, is no regular file, or holds more than ``longest_bytes``.
    """
    shown = printable(str(path))
    try:
        _refuse_other_kinds(shown, os.stat(path).st_mode)
        flags = os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC
        with open(os.open(path, flags), "rb") as stream:
            _refuse_other_kinds(shown, os.fstat(stream.fileno()).st_mode)
            payload = _at_most(stream, longest_bytes + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the name
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error)
        raise PlantError(f"{shown}: cannot be read ({reason})") from error
    if len(payload) > longest_bytes:
        raise PlantError(f"{shown}: is larger than {megabytes(longest_bytes)}; cut it")
    return payload


def read_plain_text(path: Path, longest_bytes: int) -> str:
    """Return what a regular UTF-8 file holds; errors as of `read_plain`, and for other bytes."""
    payload = read_plain(path, longest_bytes)
    try:
        return payload.decode("utf-8")
    except UnicodeDecodeError as error:
        line = payload[: error.start].count(b"\n") + 1
        raise PlantError(
            f"{printable(str(path))}: cannot be read (line {line}: byte "
            f"0x{payload[error.start]:02x} is not UTF-8); save the file as UTF-8"
        ) from error


def text_stream(path: Path, payload: bytes, longest_bytes: int) -> TextIO:
    """Return a file's content as a stream of UTF-8 text, unpacked where its name ends in .gz.

    No more than a block is unpacked at a time, so a bomb costs what was read of it.

    Raises
    ------
    PlantError, OSError, EOFError, zlib.error, UnicodeDecodeError
        While it is read: more than ``longest_bytes`` come out, or it is torn, or no such text.
    """
    plain: BinaryIO = io.BytesIO(payload)
    if path.name.lower().endswith(".gz"):
        plain = cast(BinaryIO, gzip.GzipFile(fileobj=plain))
    counted = _Counted(plain, longest_bytes, printable(str(path)))
    return io.TextIOWrapper(io.BufferedReader(counted, _CHUNK_BYTES), encoding="utf-8-sig")


def megabytes(count: int) -> str:
    """Return a number of bytes as people say it."""
    return f"{count >> 20} MB" if count >= 1 << 20 else f"{count >> 10} kB"


def _at_most(stream: BinaryIO, count: int) -> bytes:
    """Return what is there, up to ``count`` bytes; room is taken as it comes, not for all."""
    parts = []
    while count > 0 and (part := stream.read(min(count, _CHUNK_BYTES))):
        parts.append(part)
        count -= len(part)
    return b"".join(parts)


def _refuse_other_kinds(shown: str, mode: int) -> None:
    for is_kind, word in _KINDS:
        if is_kind(mode):
            raise PlantError(f"{shown}: is {word}; give a file")


class _Counted(io.RawIOBase):
    """Hands bytes on until there were too many."""

    def __init__(self, source: BinaryIO, longest_bytes: int, shown: str) -> None:
        super().__init__()
        self._source = source
        self._left = longest_bytes
        self._longest_bytes = longest_bytes
        self._shown = shown

    def readable(self) -> bool:
        return True

    def readinto(self, into: WriteableBuffer) -> int:
        part = self._source.read(len(memoryview(into)))
        self._left -= len(part)
        if self._left < 0:
            raise PlantError(
                f"{self._shown}: is larger than {megabytes(self._longest_bytes)} as plain text; "
                "cut it"
            )
        memoryview(into)[: len(part)] = part
        return len(part)
