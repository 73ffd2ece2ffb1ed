"""``python -m releasing.lock``: the exact packages of every installation, with their hashes.

The locks are written by uv for every platform and Python that the product supports. All of them
take their versions from one resolution, so that two may be installed together.
"""

from __future__ import annotations

import argparse
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

from releasing.commands import ROOT, tool

LOCKS = ROOT / "deploy" / "locks"
EXTRAS: dict[str, tuple[str, ...]] = {
    "gateway": (),
    **{name: (name,) for name in ("can", "hmi", "records", "plant", "cluster", "docs")},
}
"""Extras of ``pyproject.toml`` that each lock covers, besides what every installation needs."""

BUILD = "build"
HEADER = """\
# Exact packages of {what}, with the hashes of their files.
# Made by `make lock` (uv) from pyproject.toml; install.sh reads it with pip --require-hashes.
"""


def compile_command(source: Path, extras: tuple[str, ...], out: Path, *more: str) -> list[str]:
    """Return the command that locks what a source asks for.

    Wheels only: what an installation runs as root is no build script of somebody's.
    """
    options = [option for extra in extras for option in ("--extra", extra)]
    quiet = ["--quiet", "--no-header", "--no-annotate"]
    fixed = ["--universal", "--generate-hashes", "--only-binary", ":all:", *quiet]
    asked = [*options, *fixed, *more, "--output-file", str(out)]
    return [tool("uv"), "pip", "compile", str(source), *asked]


def _lock(source: Path, extras: tuple[str, ...], out: Path, what: str, *more: str) -> None:
    """Write one lock whole or not at all."""
    with tempfile.TemporaryDirectory() as folder:
        fresh = Path(folder) / out.name
        command = compile_command(source, extras, fresh, *more)
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        out.write_text(HEADER.format(what=what) + fresh.read_text())


def build_requirements() -> list[str]:
    """Return what ``pyproject.toml`` needs to build."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())
    return [str(asked) for asked in project["build-system"]["requires"]]


def write_locks(*, upgrade: bool) -> list[Path]:
    """Write every lock; versions already locked stay unless ``upgrade``."""
    LOCKS.mkdir(exist_ok=True)
    project = ROOT / "pyproject.toml"
    made = [LOCKS / f"{name}.txt" for name in (*EXTRAS, BUILD)]
    with tempfile.TemporaryDirectory() as folder:
        every = Path(folder) / "every.txt"
        kept = Path(folder) / "kept.txt"
        if not upgrade:
            rows = [row for path in made if path.exists() for row in pins(path)]
            kept.write_text("\n".join(rows))
        known = ["--constraint", str(kept)] if kept.exists() else []
        extras = tuple(extra for names in EXTRAS.values() for extra in names)
        command = compile_command(project, extras, every, *known)
        subprocess.run(command, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        common = Path(folder) / "common.txt"
        common.write_text("\n".join(pins(every)))
        for name, asked in EXTRAS.items():
            what = "aff-runtime" + (f"[{','.join(asked)}]" if asked else "")
            _lock(project, asked, LOCKS / f"{name}.txt", what, "--constraint", str(common))
        needs = Path(folder) / "build.in"
        needs.write_text("\n".join(build_requirements()) + "\n")
        _lock(needs, (), LOCKS / f"{BUILD}.txt", "the build", *known)
    return made


def pins(lock: Path) -> list[str]:
    """Return the pins of a lock as requirements, without hashes."""
    rows = (row.removesuffix("\\").strip() for row in lock.read_text().splitlines())
    return [row for row in rows if "==" in row and not row.startswith("#")]


def main() -> int:
    """Write the locks."""
    parser = argparse.ArgumentParser(prog="python -m releasing.lock", description=__doc__)
    parser.add_argument("--upgrade", action="store_true", help="the newest of every range")
    for path in write_locks(upgrade=parser.parse_args().upgrade):
        print(path.relative_to(ROOT))
    return 0


if __name__ == "__main__":
    sys.exit(main())
