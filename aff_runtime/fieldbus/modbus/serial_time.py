"""How long the frames of one tick take on a serial line."""

from __future__ import annotations


def transaction_ms(read_words: int, write_words: int, baud: int, *, fc23: bool) -> float:
    """Return how long one tick's transactions take on the line, ms.

    11 bits a character and 3.5 characters of silence before every frame (Modbus over Serial Line
    V1.02, 2.5.1); above 19200 baud the silence is a fixed 1.75 ms.
    """
    silence_ms = 1.75 if baud > 19_200 else 3.5 * 11e3 / baud
    if fc23:
        frames = [13 + 2 * write_words, 5 + 2 * read_words]
    else:
        frames = [9 + 2 * write_words, 8, 8, 5 + 2 * read_words]
    return sum(11e3 * n / baud + silence_ms for n in frames)
