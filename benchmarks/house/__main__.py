"""Print the shape of the code, room by room: ``python -m benchmarks.house [--rev REV ...]``.

Reads sources only: any revision of this repository will do, installed or not. ``--docs`` writes
docs/results/house.md: before the redesign of the house beside a revision (HEAD, or ``--rev``).
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

from benchmarks.house.page import BEFORE, LAID_OUT, MOST_FILES, PROVING, Proof, Revision, page
from benchmarks.house.rooms import PACKAGES, SCREEN, Room, read_modules, rooms, whole

ROOT = Path(__file__).resolve().parents[2]
PAGE = Path("docs", "results", "house.md")
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
    parser.add_argument("--docs", action="store_true", help=f"write {PAGE} of the last revision")
    options = parser.parse_args(arguments)
    if options.docs:
        write_page(options.root, (options.rev or ["HEAD"])[-1])
        return 0
    if not options.rev:
        print(table(options.root))
    for revision in options.rev or ():
        with checkout(options.root, revision) as folder:
            print(f"{revision}\n\n{table(folder)}")
    return 0


def write_page(root: Path, revision: str) -> None:
    """Write the page of a revision beside those before it."""
    now = _git(root, "rev-parse", "--short=8", revision).strip()
    found = []
    for name in (BEFORE, LAID_OUT, now):
        with checkout(root, name) as folder:
            found.append(Revision(name=name, modules=read_modules(folder)))
    proofs = [
        Proof(what=what, commit=commit, files=_files(root, commit), most=MOST_FILES[what])
        for what, commit in PROVING.items()
    ]
    (root / PAGE).write_text(page(found, proofs), encoding="utf-8")


def _files(root: Path, commit: str) -> tuple[str, ...]:
    """Return the files that a commit changes."""
    return tuple(_git(root, "show", "--format=", "--name-only", commit).split())


def _git(root: Path, *words: str) -> str:
    asked = subprocess.run(
        ["git", "-C", str(root), *words], capture_output=True, check=False, text=True
    )
    if asked.returncode:
        raise SystemExit(f"git {' '.join(words)}: {asked.stderr.strip()}")
    return asked.stdout


@contextmanager
def checkout(root: Path, revision: str) -> Iterator[Path]:
    """Give a folder with the packages of a revision; it is gone afterwards.

    Raises
    ------
    SystemExit
        git knows no such revision.
    """
    names = _git(root, "ls-tree", "--name-only", revision).split()
    there = [name for name in PACKAGES if name in names]
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
