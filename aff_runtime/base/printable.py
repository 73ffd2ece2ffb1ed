"""Text of files and wires on its way to a log or a terminal."""

from __future__ import annotations

_MORE = "..."


def printable(text: str, longest: int | None = None) -> str:
    r"""Return ``text`` on one line, with every character that does not show as itself escaped.

    Kept is what ``str.isprintable`` keeps; line breaks, ESC, and characters that turn or hide
    others (U+202E, U+2028, zero width, lone surrogates) come out as ``\n``, ``\x1b``, ``\u202e``.
    What was made printable once stays as it is. Escape foreign words before they are put into a
    sentence: the line breaks of our own messages are meant.

    Parameters
    ----------
    text : as it stands in the file.
    longest : characters of the result, dots included; None for all of it.
    """
    start = text if longest is None else text[: longest + 1]  # escapes only make it longer
    shown = start if start.isprintable() else "".join(map(_shown, start))
    if longest is None or len(shown) <= longest:
        return shown
    return (shown[: max(longest - len(_MORE), 0)] + _MORE)[:longest]


def _shown(char: str) -> str:
    return char if char.isprintable() else char.encode("unicode_escape").decode("ascii")


def text_or(value: object, absent: str = "") -> str:
    """Return ``value`` where it is a text of a file, else ``absent``.

    What is nested is never turned into text: its aliases could unfold to more than there is room
    for.
    """
    return value if isinstance(value, str) else absent
