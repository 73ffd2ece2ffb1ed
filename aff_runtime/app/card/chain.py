"""The chain: one canonical JSON object a line, each with its own hash and that of the one before.

The hash of an entry is the SHA-256 of its canonical JSON without the member ``sha256``. A line
that is not the canonical form of what it says is refused: so no byte can differ unseen. Who may
write the file can forge the whole of it, and can take the newest entries away: the newest hash
stands on the printed page, and `verify` compares it when it is given (``--newest HASH``).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from aff_runtime.base.printable import printable

START = "0" * 64
MAX_BYTES = 16 << 20  # of a file
LONGEST_LINE = 1 << 20  # bytes
MOST_ENTRIES = 5_000
MEMBERS = frozenset({"n", "utc", "kind", "body", "prev", "sha256"})


@dataclass(frozen=True, slots=True, kw_only=True)
class Link:
    """One entry as it lies in the file.

    Attributes
    ----------
    number : from 1 on. ``utc`` : when. ``kind`` : what ``body`` is.
    body : plain values. ``sha256`` : of the entry.
    """

    number: int
    utc: str
    kind: str
    body: Any
    sha256: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """The entries as far as the chain holds, and what is wrong behind them; empty: nothing."""

    links: tuple[Link, ...] = ()
    wrong: str = ""

    @property
    def newest(self) -> str:
        """Hash of the last entry."""
        return self.links[-1].sha256 if self.links else START


class _RefusedError(ValueError):
    """A line is no entry; the text says why."""


def canonical(value: Any) -> bytes:
    """Return the one form in which plain values are written and hashed.

    Raises
    ------
    ValueError
        A number is not finite.
    """
    text = json.dumps(
        value, sort_keys=True, separators=(",", ":"), ensure_ascii=True, allow_nan=False
    )
    return text.encode("ascii")


def encode(*, number: int, utc: str, kind: str, body: Any, prev: str) -> bytes:
    """Return one entry as a line of the file, its line end with it."""
    entry = {"n": number, "utc": utc, "kind": kind, "body": body, "prev": prev}
    digest = hashlib.sha256(canonical(entry)).hexdigest()
    return canonical({**entry, "sha256": digest}) + b"\n"


def follow(content: bytes) -> Chain:
    """Return the entries of a file's content as far as they hold."""
    if len(content) > MAX_BYTES:
        return Chain(wrong=f"is larger than {MAX_BYTES >> 20} MB: no card of ours")
    if not content:
        return Chain(wrong="is empty: its first entry is missing")
    lines, rest = content.split(b"\n")[:-1], content.rpartition(b"\n")[2]
    if len(lines) > MOST_ENTRIES:
        return Chain(wrong=f"has more than {MOST_ENTRIES} entries: no card of ours")
    links: list[Link] = []
    prev = START
    for at, line in enumerate(lines, start=1):
        try:
            link = _link(line, at, prev)
        except _RefusedError as error:
            return Chain(links=tuple(links), wrong=f"entry {at}: {error}")
        links.append(link)
        prev = link.sha256
    if rest:
        return Chain(links=tuple(links), wrong=f"entry {len(lines) + 1}: ends in half a line")
    return Chain(links=tuple(links))


def _link(line: bytes, at: int, prev: str) -> Link:
    said = _plain(line)
    if not isinstance(said, dict):
        raise _RefusedError("is no JSON object")
    if set(said) != MEMBERS:
        odd = ", ".join(printable(name, 40) for name in sorted(set(said) ^ MEMBERS)[:5])
        raise _RefusedError(f"its members are not those of an entry (missing or too many: {odd})")
    number, digest = said["n"], said.pop("sha256")
    texts = (said["utc"], said["kind"], said["prev"], digest)
    if isinstance(number, bool) or not isinstance(number, int):
        raise _RefusedError("its number is not a whole one")
    if not all(isinstance(text, str) for text in texts):
        raise _RefusedError("time, kind or a hash of it is no text")
    if _as_written({**said, "sha256": digest}) != line:
        raise _RefusedError("is not written in canonical form: it was written by something else")
    if hashlib.sha256(canonical(said)).hexdigest() != digest:
        raise _RefusedError("its content does not have its hash: it was changed")
    if number != at:
        raise _RefusedError(f"its number is {number}: an entry is missing, or was put in")
    if said["prev"] != prev:
        raise _RefusedError("does not follow the entry before it: one was taken out or exchanged")
    return Link(
        number=number, utc=said["utc"], kind=said["kind"], body=said["body"], sha256=digest
    )


def _as_written(said: Any) -> bytes:
    try:
        return canonical(said)
    except (ValueError, RecursionError):  # 1e999 is read as infinite
        raise _RefusedError("holds a number beyond all floats, or is nested too deep") from None


def _plain(line: bytes) -> Any:
    """Return the plain values of a line; a key that stands twice, NaN, infinity are none."""
    if len(line) > LONGEST_LINE:
        raise _RefusedError(f"is longer than {LONGEST_LINE >> 10} kB")
    try:
        return json.loads(line.decode("ascii"), object_pairs_hook=_once, parse_constant=_no_number)
    except UnicodeDecodeError:
        raise _RefusedError("holds bytes that are no ASCII") from None
    except _RefusedError:
        raise
    except RecursionError:
        raise _RefusedError("is nested too deep") from None
    except ValueError as error:
        raise _RefusedError(f"is no JSON ({printable(str(error), 120)})") from None


def _once(pairs: Sequence[tuple[str, Any]]) -> Any:
    found = dict(pairs)
    if len(found) != len(pairs):
        names = [name for name, _ in pairs]
        twice = next(name for name in names if names.count(name) > 1)
        raise _RefusedError(f"the key {printable(twice, 40)!r} stands twice in it")
    return found


def _no_number(word: str) -> Any:
    raise _RefusedError(f"{word} is no number of a card")
