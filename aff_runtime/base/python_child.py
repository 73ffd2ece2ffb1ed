"""How a Python process of ours is started: never with modules of the working folder."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import asyncio


def module_command(module: str) -> list[str]:
    """Return the command that runs ``module`` with this interpreter; arguments may follow.

    ``python -m`` puts the working folder first on the module path: a file that lies there and is
    named like something we import would run in our process. ``-P`` leaves the folder out;
    PYTHONPATH and the environment's own packages stay.
    """
    return [sys.executable, "-P", "-m", module]


def program_beside(name: str) -> Path:
    """Return where a program of this environment lies, there or not.

    Such a script has its own folder on the module path, never the one that it is started in.
    """
    return Path(sys.executable).with_name(name)


async def talking_child(
    module: str, environment: Mapping[str, str], most_bytes: int
) -> asyncio.subprocess.Process:
    """Start ``module`` and return its process, lines of at most ``most_bytes`` on both pipes."""
    import asyncio  # noqa: PLC0415 (its caller has it; who starts a plain child needs none)

    return await asyncio.create_subprocess_exec(
        *module_command(module),
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE,
        env=environment,
        limit=most_bytes,
    )
