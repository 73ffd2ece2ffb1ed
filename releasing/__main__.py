"""``python -m releasing``: make a release of the commit that is checked out."""

from __future__ import annotations

import argparse
import shutil
import sys
import tempfile
from pathlib import Path

from releasing.build import build_twice, clean_commit
from releasing.commands import ROOT, ReleaseError, run
from releasing.lock import LOCKS
from releasing.materials import bill, install_all, write_materials
from releasing.sums import sign, write_sums


def release(out: Path, key: str) -> None:
    """Make everything anew in a folder; what was there goes only when all is made."""
    commit = clean_commit()
    with tempfile.TemporaryDirectory() as folder:
        work, fresh = Path(folder), Path(folder) / "release"
        fresh.mkdir()
        source, *wheels = build_twice(commit, work, fresh)
        python = install_all(wheels[-1], work / "environment")
        said = run([str(python.with_name("aff-runtime")), "--version"]).strip()
        if commit not in said:
            raise ReleaseError(f"the wheel says {said!r}, not its commit {commit}")
        if len(wheels) > 1 and not said.endswith("law by compiled"):
            raise ReleaseError(f"{wheels[-1].name} was built, but its program says {said!r}")
        print(f"{said}: {', '.join(path.name for path in (source, *wheels))}")
        silent = write_materials(bill(python), fresh)
        print(f"licences.tsv: {len(silent)} packages state no licence {' '.join(silent)}".rstrip())
        for lock in sorted(LOCKS.glob("*.txt")):
            shutil.copy(lock, fresh / f"lock-{lock.name}")
        print(sign(write_sums(fresh), key))
        if out.exists():
            shutil.rmtree(out)
        shutil.copytree(fresh, out)
    print(f"{len(list(out.iterdir()))} files in {out}")


def main() -> int:
    """Make a release."""
    parser = argparse.ArgumentParser(prog="python -m releasing", description=__doc__)
    parser.add_argument("--sign", default="", metavar="KEY", help="key id of gpg, or ssh key file")
    options = parser.parse_args()
    try:
        release(ROOT / "out" / "release", options.sign)
    except ReleaseError as error:
        print(f"make release: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
