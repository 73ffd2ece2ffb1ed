"""How a Python process of ours is started: never with modules of the working folder."""

from __future__ import annotations

import sys


def module_command(module: str) -> list[str]:
    """Return the command that runs ``module`` with this interpreter; arguments may follow.

    ``python -m`` puts the working folder first on the module path: a file that lies there and is
    named like something we import would run in our process. ``-P`` leaves the folder out;
    PYTHONPATH and the environment's own packages stay.
    """
    return [sys.executable, "-P", "-m", module]
