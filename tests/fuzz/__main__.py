"""``python -m tests.fuzz --seconds S [--out FOLDER] [TARGET ...]``: every target for its share.

Exit code 1 when an input broke one; it is kept in FOLDER as TARGET.broken, and
``python -m tests.fuzz --again FOLDER/TARGET.broken`` runs it once more.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.fuzz.targets import TARGETS

START_UP_S = 120.0  # for imports with coverage, on a busy machine


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.fuzz")
    parser.add_argument("targets", nargs="*", metavar="TARGET", help=", ".join(TARGETS))
    parser.add_argument("--seconds", type=float, default=130.0, help="in all (default 130)")
    parser.add_argument("--out", type=Path, default=Path("out/fuzz"))
    parser.add_argument("--again", type=Path, help="one input that broke a target")
    options = parser.parse_args()
    if options.again:
        print(TARGETS[options.again.name.partition(".")[0]].run(options.again.read_bytes()))
        return 0
    unknown = set(options.targets) - set(TARGETS)
    if unknown:
        parser.error(f"no target {', '.join(sorted(unknown))}; there are {', '.join(TARGETS)}")
    names = options.targets or list(TARGETS)
    options.out.mkdir(parents=True, exist_ok=True)
    broken = [name for name in names if not run(name, options.seconds / len(names), options.out)]
    print(f"{len(names) - len(broken)} of {len(names)} targets held")
    return 1 if broken else 0


def run(name: str, seconds: float, folder: Path) -> bool:
    """Fuzz one target in a process of its own and print what came of it; True when it held."""
    command = [sys.executable, "-m", "tests.fuzz.guided", name, str(seconds), str(folder)]
    with tempfile.TemporaryDirectory(prefix="aff-fuzz-") as place:  # a guided child cleans nothing
        done = subprocess.run(
            command,
            capture_output=True,
            text=True,
            timeout=seconds + START_UP_S,
            check=False,
            env={**os.environ, "TMPDIR": place},
        )
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    if not lines:
        print(f"{name:14} ended by itself (exit {done.returncode})\n{done.stderr[-2000:]}")
        return False
    said = json.loads(lines[-1])
    became = ", ".join(f"{count} {word}" for word, count in sorted(said["became"].items()))
    print(f"{name:14} {said['runs']:8} inputs by {said['by']}: {became}", flush=True)
    if said["trouble"]:
        print(f"  broken by {folder / name}.broken\n{said['trouble']}")
    return not said["trouble"]


if __name__ == "__main__":
    sys.exit(main())
