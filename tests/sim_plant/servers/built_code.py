"""Code in C as a library of PLC code."""

from __future__ import annotations

import subprocess
from pathlib import Path

from sim_plant.base.shipped import shipped_plc


def built(folder: Path, text: str) -> Path:
    (folder / "plc.c").write_text(text)
    words = ["cc", "-Wall", "-Werror", "-shared", "-fPIC", "-I", str(shipped_plc(""))]
    words += [str(folder / "plc.c"), "-o", str(folder / "plc.so")]
    subprocess.run(words, check=True, timeout=60)
    return folder / "plc.so"
