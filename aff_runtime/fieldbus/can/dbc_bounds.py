"""Numbers of a DBC file that no frame has, refused before the reader multiplies them.

The reader lays out every message bit by bit and every page of a multiplexer by itself, so that
one line with a large number costs gigabytes or minutes. This looks at the file's words alone.
"""

from __future__ import annotations

import re
from typing import Final

from aff_runtime.fieldbus.signal_names import WireFileError

MOST_BYTES: Final = 64  # of a CAN FD frame
MOST_BITS: Final = 8 * MOST_BYTES
MOST_PAGES: Final = 1 << 16  # all ranges of SG_MUL_VAL_ together; a page selector has 8 or 16 bit

# The words as the reader parts them: white space and comments, then texts, numbers, names, signs.
_WORD = re.compile(
    r'(?P<skip>[ \r\n\t]+|//.*?\n)|"(?:\\"|[^"])*?"'
    r"|[-+]?\d+\.?\d*(?:[eE][+-]?\d+)?|[A-Za-z0-9_]+|.",
    re.DOTALL,
)


def check_bounds(text: str, where: str) -> None:
    """Look at every message, signal and range of pages of a DBC file's text.

    Raises
    ------
    ConfigError
        A number is beyond what a frame can have; with the file's line.
    """
    found = [(word[0], word.start()) for word in _WORD.finditer(text) if word["skip"] is None]
    words = [word for word, _ in found]
    pages = 0
    for k, (word, at) in enumerate(found):
        said = ""
        if word == "BO_":
            said = _message(words[k + 1 : k + 5])
        elif word == "SG_":
            said = _signal(words[k + 1 : k + 7])
        elif word == "SG_MUL_VAL_":
            pages += _pages(words, k + 1)
            if pages > MOST_PAGES:
                said = f"its multiplexers have over {MOST_PAGES} pages. Leave in it what is used"
        if said:
            raise WireFileError(where, said, text.count("\n", 0, at) + 1)


def _message(words: list[str]) -> str:
    """Return what is wrong with ``388 PLC_STATUS : 8``, empty for what is no message."""
    match words:
        case [_, name, ":", length] if not 0 <= _whole(length) <= MOST_BYTES:
            return f"message {name} of {length:.20} bytes; a frame has {MOST_BYTES} at most"
    return ""


def _signal(words: list[str]) -> str:
    """Return what is wrong with ``Tension m0 : 16 | 16``, empty for what is no signal."""
    match words:
        case [name, ":", start, "|", length, *_] | [name, _, ":", start, "|", length]:
            if not (0 <= _whole(start) < MOST_BITS and _whole(length) <= MOST_BITS):
                return (
                    f"signal {name} of {length:.20} bits from bit {start:.20} on; a frame has "
                    f"{MOST_BITS} bits at most"
                )
    return ""


def _pages(words: list[str], at: int) -> int:
    """Return how many pages ``388 Tension Page 0 -3 , 7 -7 ;`` names, its words from ``at``."""
    pages = 0
    at += 3
    while at + 1 < len(words) and words[at] != ";":
        if words[at] == ",":
            at += 1
            continue
        low, high = words[at : at + 2]
        pages += max(0, _whole(high[1:]) - _whole(low) + 1)  # as the reader takes them
        at += 2
        if pages > MOST_PAGES or not words[at - 1].lstrip("+-").isdecimal():
            break
    return pages


def _whole(word: str) -> int:
    """Return the number that is written; 0 for what is none, which the reader refuses itself."""
    try:
        return int(word)
    except ValueError:
        return 0
