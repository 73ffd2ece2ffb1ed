"""The machine's own binary of an exported line, where it has a compiler."""

from __future__ import annotations

import platform
import shutil
import subprocess
import sys
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.export.description import OPTIONS, Version

FOLDERS = {
    ("linux", "x86_64", "3.0"): "x86_64-linux",
    ("linux", "x86_64", "2.0"): "linux64",
    ("linux", "aarch64", "3.0"): "aarch64-linux",
    ("linux", "aarch64", "2.0"): "aarch64-linux",
}


def binary_folder(version: Version) -> str | None:
    """Return the folder of this machine's binaries in an FMU; None: not known here."""
    return FOLDERS.get((sys.platform, platform.machine(), version))


def compiler() -> str | None:
    """Return the machine's C compiler, or None."""
    return shutil.which("cc") or shutil.which("gcc")


def compile_binary(program: str, sources: Path, main: str, target: Path) -> None:
    """Compile a shared object from the sources of an FMU.

    Raises
    ------
    PlantError
        When the compiler does not take them; the message has its first lines.
    """
    target.parent.mkdir(parents=True, exist_ok=True)
    shared = ("-shared", "-fPIC", "-fvisibility=hidden", "-s")
    command = [program, *OPTIONS, *shared, main, "-o", str(target.resolve()), "-lm"]
    made = subprocess.run(command, cwd=sources, capture_output=True, text=True, check=False)
    if made.returncode != 0:
        said = "\n".join(made.stderr.splitlines()[:5])
        raise PlantError(f"{program} does not compile {main}: {said}")
