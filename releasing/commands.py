"""Programs that a release is made with: found beside this Python, or on PATH."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[1]


class ReleaseError(Exception):
    """A release that cannot be made, with what to do."""


def tool(name: str) -> str:
    """Return the path of a program.

    Raises
    ------
    ReleaseError
        It is not installed.
    """
    beside = Path(sys.executable).parent / name
    found = str(beside) if beside.exists() else shutil.which(name)
    if found is None:
        raise ReleaseError(f"{name}: not found; pip install -e '.[release]' brings it")
    return found


def run(
    command: Sequence[str], *, cwd: Path = ROOT, environment: Mapping[str, str] | None = None
) -> str:
    """Run a command and return what it printed.

    Raises
    ------
    ReleaseError
        It failed; the message ends with its own words.
    """
    done = subprocess.run(
        list(command), cwd=cwd, env=environment, capture_output=True, text=True, check=False
    )
    if done.returncode:
        said = (done.stderr.strip() or done.stdout.strip())[-2000:]
        raise ReleaseError(f"{' '.join(command)}: exit {done.returncode}\n{said}")
    return done.stdout
