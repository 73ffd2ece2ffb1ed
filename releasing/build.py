"""Source archive and wheel of one commit, the same bytes wherever they are built."""

from __future__ import annotations

import gzip
import os
import shutil
import stat
import tarfile
import zipfile
from pathlib import Path

from releasing.commands import ReleaseError, run, tool
from releasing.lock import BUILD, LOCKS
from releasing.sums import sha256


def clean_commit() -> str:
    """Return the commit of a tree without changes.

    Raises
    ------
    ReleaseError
        Files differ from the commit, or are not in it.
    """
    changed = run(["git", "status", "--porcelain"]).splitlines()
    if changed:
        raise ReleaseError(
            f"{len(changed)} files differ from the commit, {changed[0].strip()} first; a release "
            "is made of a commit: commit them or take them out"
        )
    return run(["git", "rev-parse", "HEAD"]).strip()


def epoch_s(commit: str) -> int:
    """Return the commit's time, s since 1970: the time of every file in the archives."""
    return int(run(["git", "show", "-s", "--format=%ct", commit]))


def export(commit: str, folder: Path) -> None:
    """Write the files of a commit into a folder, with its id in them."""
    folder.mkdir(parents=True)
    packed = folder.with_suffix(".export.tar")
    run(["git", "-c", "tar.umask=022", "archive", f"--output={packed}", commit])
    with tarfile.open(packed) as archive:
        archive.extractall(folder, filter="data")
    packed.unlink()


def repack(source: Path, out: Path, mtime_s: int) -> None:
    """Write a source archive anew: sorted, one time, one owner, modes 644 and 755."""
    with tarfile.open(source) as old, out.open("wb") as raw:
        squeezed = gzip.GzipFile(filename="", fileobj=raw, mode="wb", mtime=mtime_s)
        with squeezed, tarfile.open(fileobj=squeezed, mode="w", format=tarfile.PAX_FORMAT) as new:
            for member in sorted(old.getmembers(), key=lambda each: each.name):
                runs = member.isdir() or bool(member.mode & 0o100)
                plain = member.replace(
                    mtime=mtime_s, uid=0, gid=0, uname="", gname="", mode=0o755 if runs else 0o644
                )
                plain.pax_headers = {}
                new.addfile(plain, old.extractfile(member) if member.isreg() else None)


def repack_wheel(wheel: Path, out: Path) -> None:
    """Write a wheel anew with modes 644 and 755: setuptools keeps those of the builder's umask.

    Order, times and bytes of its files stay, so its RECORD holds.
    """
    with zipfile.ZipFile(wheel) as old, zipfile.ZipFile(out, "w") as new:
        for member in old.infolist():
            runs = bool(member.external_attr >> 16 & 0o100)
            plain = zipfile.ZipInfo(member.filename, member.date_time)
            plain.create_system = 3  # Unix: the modes are read
            plain.external_attr = (stat.S_IFREG | (0o755 if runs else 0o644)) << 16
            plain.compress_type = zipfile.ZIP_DEFLATED
            new.writestr(plain, old.read(member))


def kinds() -> tuple[str, ...]:
    """Return the wheels to build: for every machine, and with the binary where a compiler is."""
    if shutil.which("cc") is None:
        print("no C compiler (cc): no wheel with the law's binary; the others are whole")
        return ("numpy",)
    return ("numpy", "compiled")


def build(commit: str, folder: Path, *, umask: int, zone: str) -> list[Path]:
    """Return source archive and wheels of a commit; the wheels are built from the archive.

    Parameters
    ----------
    folder : new; everything is made below it.
    umask, zone : of the building process, so that two builds differ in what must not matter.
    """
    moment_s = epoch_s(commit)
    before = os.umask(umask)
    try:
        export(commit, folder / "source")
        environment = {
            **os.environ,
            "SOURCE_DATE_EPOCH": str(moment_s),
            "TZ": zone,
            "PYTHONPATH": "",
            "LDSHARED": "cc -shared",  # Python's own names the folder of its libraries
        }
        locked = [
            "--build-constraints",
            str(LOCKS / f"{BUILD}.txt"),
            "--require-hashes",
            "--quiet",
        ]
        make = [tool("uv"), "build", "--python", tool("python"), *locked]
        run(
            [*make, "--sdist", "--out-dir", str(folder / "raw"), str(folder / "source")],
            environment=environment,
        )
        (raw,) = (folder / "raw").glob("*.tar.gz")
        done = folder / "dist"
        done.mkdir()
        repack(raw, done / raw.name, moment_s)
        made = [done / raw.name]
        for kind in kinds():
            into = folder / kind
            run(
                [*make, "--wheel", "--out-dir", str(into), str(made[0])],
                environment={**environment, "AFF_RUNTIME_BUILD": kind},
            )
            (wheel,) = into.glob("*.whl")
            made.append(done / wheel.name)
            repack_wheel(wheel, made[-1])
    finally:
        os.umask(before)
    return made


def build_twice(commit: str, work: Path, out: Path) -> list[Path]:
    """Build in two places under unlike umasks and time zones; keep what is equal.

    Raises
    ------
    ReleaseError
        The two differ.
    """
    first = build(commit, work / "one", umask=0o022, zone="UTC")
    second = build(commit, work / "elsewhere" / "two", umask=0o077, zone="Pacific/Auckland")
    kept = []
    for one, other in zip(first, second, strict=True):
        sums = sha256(one), sha256(other)
        print(f"{one.name}\n  first build   {sums[0]}\n  second build  {sums[1]}")
        if sums[0] != sums[1]:
            raise ReleaseError(f"{one.name}: two builds differ: {one} and {other}")
        kept.append(Path(shutil.copy(one, out)))
    return kept
