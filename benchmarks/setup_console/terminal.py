"""A command at a pseudo-terminal, answered by a function."""

from __future__ import annotations

import os
import pty
import re
import select
import subprocess
from collections.abc import Callable, Sequence

PATIENCE_S = 120.0
_PROMPT = re.compile(r".+: ")


def play(command: Sequence[str], answer: Callable[[str], str]) -> tuple[int, str]:
    """Run a command; return its exit code and everything that it showed.

    Parameters
    ----------
    answer : returns what is typed after a prompt; what it raises ends the command.
    """
    ours, theirs = pty.openpty()
    child = subprocess.Popen(command, stdin=theirs, stdout=theirs, stderr=theirs, close_fds=True)
    os.close(theirs)
    shown, asked = "", 0
    try:
        while True:
            ready, _, _ = select.select([ours], [], [], PATIENCE_S)
            try:
                fresh = os.read(ours, 65536).decode(errors="replace") if ready else ""
            except OSError:  # the other end is closed
                fresh = ""
            if not fresh:
                break
            shown += fresh.replace("\r", "")
            last = shown[asked:].rpartition("\n")[2]
            if _PROMPT.fullmatch(last):
                os.write(ours, f"{answer(last)}\n".encode())
                asked = len(shown)
    except BaseException:
        child.terminate()
        raise
    finally:
        os.close(ours)
    try:
        return child.wait(10.0), shown
    except subprocess.TimeoutExpired:  # it neither asks nor says anything
        child.terminate()
        return child.wait(10.0), shown
