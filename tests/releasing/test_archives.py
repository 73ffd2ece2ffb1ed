"""Archives of one content have one form, whatever the builder's umask, order and clock."""

from __future__ import annotations

import os
import tarfile
import zipfile
from pathlib import Path

import pytest

from releasing.build import kinds, repack, repack_wheel
from releasing.sums import sha256, write_sums

FILES = {"pkg/__init__.py": b"value = 1\n", "pkg/tool.sh": b"#!/bin/sh\n"}


def wheel_of(path: Path, umask: int) -> Path:
    """Write a wheel as a builder with this umask does."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as made:
        for name, content in FILES.items():
            info = zipfile.ZipInfo(name, (2026, 1, 2, 3, 4, 6))
            wanted = 0o777 if name.endswith(".sh") else 0o666
            info.external_attr = (0o100000 | wanted & ~umask) << 16
            made.writestr(info, content)
    return path


def source_of(folder: Path, umask: int, names: list[str], mtime_s: int) -> Path:
    """Write a source archive as a builder with this umask and clock does."""
    path = folder / f"{umask:o}.tar.gz"
    with tarfile.open(path, "w:gz") as made:
        for name in names:
            file = folder / f"{umask:o}-{name.replace('/', '-')}"
            file.write_bytes(FILES[name])
            file.chmod((0o777 if name.endswith(".sh") else 0o666) & ~umask)
            os.utime(file, (mtime_s, mtime_s))
            made.add(file, name)
    return path


def test_a_wheel_is_the_same_whatever_the_builders_umask(tmp_path: Path) -> None:
    raw = [wheel_of(tmp_path / f"{umask:o}.whl", umask) for umask in (0o022, 0o077)]
    assert sha256(raw[0]) != sha256(raw[1])
    done = [path.with_suffix(".done") for path in raw]
    for before, after in zip(raw, done, strict=True):
        repack_wheel(before, after)
    assert sha256(done[0]) == sha256(done[1])
    with zipfile.ZipFile(done[1]) as wheel:
        assert {name: wheel.read(name) for name in wheel.namelist()} == FILES
        modes = [member.external_attr >> 16 for member in wheel.infolist()]
        assert modes == [0o100644, 0o100755]
        assert {member.date_time for member in wheel.infolist()} == {(2026, 1, 2, 3, 4, 6)}


def test_a_source_archive_is_the_same_whatever_umask_order_and_clock(tmp_path: Path) -> None:
    names = list(FILES)
    raw = [
        source_of(tmp_path, 0o022, names, 1_700_000_000),
        source_of(tmp_path, 0o077, names[::-1], 1_800_000_000),
    ]
    done = [tmp_path / "one", tmp_path / "two"]
    for before, after in zip(raw, done, strict=True):
        repack(before, after, 1_750_000_000)
    assert sha256(done[0]) == sha256(done[1])
    with tarfile.open(done[0]) as archive:
        found = {each.name: (each.mode, each.mtime, each.uname) for each in archive}
    assert found == {
        "pkg/__init__.py": (0o644, 1_750_000_000, ""),
        "pkg/tool.sh": (0o755, 1_750_000_000, ""),
    }


@pytest.mark.parametrize("signature", ["SHA256SUMS.sig", "SHA256SUMS.asc"])
def test_sums_name_every_file_but_themselves_and_their_signature(
    tmp_path: Path, signature: str
) -> None:
    (tmp_path / "b.txt").write_bytes(b"")
    (tmp_path / "a.txt").write_bytes(b"abc")
    (tmp_path / signature).write_bytes(b"old")
    # the digests of FIPS 180-4's example "abc" and of nothing
    assert write_sums(tmp_path).read_text() == (
        "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad  a.txt\n"
        "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855  b.txt\n"
    )


def test_without_a_compiler_the_wheel_for_every_machine_is_built_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    assert kinds() == ("numpy",)
    assert "no C compiler" in capsys.readouterr().out
    (tmp_path / "cc").write_text("#!/bin/sh\n")
    (tmp_path / "cc").chmod(0o755)
    assert kinds() == ("numpy", "compiled")
