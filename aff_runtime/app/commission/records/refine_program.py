"""Runs `sim-plant refine` as a program of its own: nothing of the plant is in this process."""

from __future__ import annotations

import importlib.util
import os
import select
import shlex
import subprocess
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path

from aff_runtime.app.check.limits import ONE_THREAD
from aff_runtime.app.commission.background_process import give_way
from aff_runtime.app.supervisor.child_environment import without_service_manager
from aff_runtime.base.clock import MonotonicClock
from aff_runtime.base.errors import RefusedError
from aff_runtime.base.printable import printable
from aff_runtime.base.python_child import program_beside

PROGRAM = "sim-plant"
EXTRA = ("numba", "scipy", "matplotlib", "jinja2", "ruamel.yaml")
"""What the extra `plant` brings: without one of them no refinement is done."""
LONGEST_S = 4 * 3600.0  # of the clock
PROCESSOR_S = 2 * 3600  # of processor time
FILE_BYTES = 64 << 20  # of one file that it writes
LOG_BYTES = 1 << 20  # that are kept of what it says
LOOK_S = 1.0  # between two looks at the clock while it says nothing
TOO_LONG = (
    f"it took longer than {LONGEST_S / 3600:g} h, or {PROCESSOR_S // 3600} h of a processor, and "
    "was ended: give shorter or fewer windows, or leave effects out (--without)"
)


def program() -> Path | None:
    """Return the program beside this interpreter, None where it is not installed whole."""
    found = program_beside(PROGRAM)
    is_whole = all(_is_there(name) for name in EXTRA)
    return found if is_whole and os.access(found, os.X_OK) else None


def _is_there(name: str) -> bool:
    try:
        return importlib.util.find_spec(name) is not None
    except ModuleNotFoundError:  # its parent is missing
        return False


def command_of(
    line: str,
    windows: Sequence[str],
    holdout: Sequence[str],
    without: Sequence[str],
    *,
    site: str,
    out: str,
) -> tuple[str, ...]:
    """Return the arguments of ``sim-plant`` of a refinement with one process.

    ``line``, ``site``, ``out`` : paths. ``without`` : effects that are not looked for, by name.
    """
    arguments = ["refine", line, *windows]
    arguments += [part for one in holdout for part in ("--holdout", one)]
    arguments += [part for one in without for part in ("--without", one)]
    return (*arguments, "--site", site, "--workers", "1", "--out", out)


def command_line(arguments: Sequence[str]) -> str:
    """Return a command as a person types it."""
    return f"{PROGRAM} {shlex.join(arguments)}"


def run(arguments: Sequence[str], log: Path, say: Callable[[str], None]) -> str:
    """Run the program to its end; return why it has failed, empty where it has not.

    It has the lowest priority, not the processor of the control process, and bounds of time and
    of a file's size; it ends with this process.

    Parameters
    ----------
    log : gets what it says, up to ``LOG_BYTES``. ``say`` : takes each line of it.

    Raises
    ------
    RefusedError
        It is not installed, or cannot be started.
    """
    found = program()
    if found is None:
        raise RefusedError("sim-plant is not installed here")
    environment = without_service_manager() | ONE_THREAD
    complaints = log.with_suffix(".err")
    try:
        with (
            log.open("wb") as log_file,
            complaints.open("wb") as errors,
            subprocess.Popen(
                [os.fspath(found), *arguments],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=errors,
                env=environment,
                preexec_fn=partial(give_way, PROCESSOR_S, FILE_BYTES),  # noqa: PLW1509 - one thread
            ) as process,
        ):
            in_time = _listen(process, log_file.write, say)
    except OSError as error:
        raise RefusedError(f"sim-plant cannot be started: {error.strerror}") from None
    if not in_time or process.returncode < 0:
        return TOO_LONG
    return "" if process.returncode == 0 else _last_words(complaints, process.returncode)


def _listen(
    process: subprocess.Popen[bytes], keep: Callable[[bytes], int], say: Callable[[str], None]
) -> bool:
    """Take what a program says until it ends; False where it was ended for its time."""
    clock = MonotonicClock()
    end_ns = clock.now_ns() + int(LONGEST_S * 1e9)
    assert process.stdout is not None
    descriptor = process.stdout.fileno()
    rest, kept = b"", 0
    try:
        while clock.now_ns() < end_ns:
            if not select.select([descriptor], [], [], LOOK_S)[0]:
                continue
            part = os.read(descriptor, 1 << 16)
            if not part:
                process.wait()
                return True
            kept += keep(part[: max(0, LOG_BYTES - kept)])
            *lines, rest = (rest + part).split(b"\n")
            for line in lines:
                say(line.decode("utf-8", "replace"))
            rest = rest[-LOG_BYTES:]
        return False
    finally:
        if process.poll() is None:
            process.kill()
            process.wait()


def _last_words(complaints: Path, code: int) -> str:
    """Return the last line of what a program wrote to stderr; it says why it failed."""
    try:
        with complaints.open("rb") as file:
            file.seek(max(0, complaints.stat().st_size - 4000))
            lines = file.read().decode("utf-8", "replace").strip().splitlines()
    except OSError:
        lines = []
    said = lines[-1].removeprefix(f"{PROGRAM}: ") if lines else ""
    return printable(said, 900) or f"it ended with code {code} and said nothing"
