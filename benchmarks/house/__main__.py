"""Print the shape of the code, room by room: ``python -m benchmarks.house [--rev REV ...]``.

Reads sources only: any revision of this repository will do, installed or not.
"""

from __future__ import annotations

import argparse
import io
import subprocess
import tarfile
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from benchmarks.house.rooms import PACKAGES, SCREEN, Room, read_modules, rooms, whole

ROOT = Path(__file__).resolve().parents[2]
HEAD = (
    "room",
    "modules",
    "lines",
    "rooms",
    "floors",
    "arrows",
    "circles",
    f"over {SCREEN} lines",
    "untyped",
    "fmt skip",
    "longest function",
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Print one table per revision; the folder as it is where none is named."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.house", description=__doc__)
    parser.add_argument("--rev", action="append", help="a revision; may be given again")
    parser.add_argument("--root", type=Path, default=ROOT, help="a checkout (default: this one)")
    options = parser.parse_args(arguments)
    if not options.rev:
        print(table(options.root))
    for revision in options.rev or ():
        with checkout(options.root, revision) as folder:
            print(f"{revision}\n\n{table(folder)}")
    return 0


@contextmanager
def checkout(root: Path, revision: str) -> Iterator[Path]:
    """Give a folder with the packages of a revision; it is gone afterwards.

    Raises
    ------
    SystemExit
        git knows no such revision.
    """
    names = subprocess.run(
        ["git", "-C", str(root), "ls-tree", "--name-only", revision],
        capture_output=True,
        check=False,
        text=True,
    )
    if names.returncode:
        raise SystemExit(f"--rev {revision}: {names.stderr.strip()}")
    there = [name for name in PACKAGES if name in names.stdout.split()]
    packed = subprocess.run(
        ["git", "-C", str(root), "archive", "--format=tar", revision, *there],
        capture_output=True,
        check=True,
    )
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(fileobj=io.BytesIO(packed.stdout)) as archive:
            archive.extractall(folder, filter="data")
        yield Path(folder)


def table(root: Path) -> str:
    """Return the figures of a checkout as a Markdown table.

    ``rooms``, ``floors``, ``arrows`` and ``circles`` are of what lies directly in a room;
    all other columns are of everything in it.
    """
    modules = read_modules(root)
    out = [f"| {' | '.join(HEAD)} |", "|---" * len(HEAD) + "|"]
    out += [_line(room) for room in (whole(modules), *rooms(modules))]
    return "\n".join(out) + "\n"


def _line(room: Room) -> str:
    function, length = room.longest
    cells = (
        room.name,
        room.modules,
        room.lines,
        room.rooms,
        room.floors,
        room.arrows,
        room.circles,
        room.long_functions,
        room.untyped,
        room.skips,
        f"{function} {length}",
    )
    return f"| {' | '.join(str(cell) for cell in cells)} |"


if __name__ == "__main__":
    raise SystemExit(main())
