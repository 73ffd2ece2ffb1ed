"""A screen that uses all that its unit lets it have: half of a processor, for ever."""

from __future__ import annotations

import threading
import time

BURST_S = 0.05


def burn() -> None:
    """Use the processor every other twentieth of a second."""
    rest = threading.Event()  # that nobody sets
    while True:
        end = time.perf_counter() + BURST_S
        while time.perf_counter() < end:
            pass
        rest.wait(BURST_S)


if __name__ == "__main__":
    burn()
