"""What is cleared away and what is replaced: our own files, and nothing through a link."""

from __future__ import annotations

import os
import stat
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.base import files
from aff_runtime.base.files import replace_text
from aff_runtime.telemetry.disk_bound import delete_oldest, used_bytes
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
from tests.aff_runtime.telemetry.heads import head_of

SECRET = "root:*:20228:0:99999:7:::\n"
OLD, NEW = "20260101T000000Z_line", "20260102T000000Z_line"


def run(directory: Path, name: str, segments: int = 3) -> Path:
    folder = directory / name
    folder.mkdir(parents=True)
    for k in range(1, segments + 1):
        (folder / f"signals-{k:04d}.csv.gz").write_bytes(bytes(1000))
    for other in ("run.yaml", "site.yaml", "events.csv", "summary.json"):
        (folder / other).write_bytes(bytes(10))
    return folder


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_a_link_named_like_a_run_is_not_followed(tmp_path: Path) -> None:
    foreign = run(tmp_path / "foreign", OLD)
    runs = tmp_path / "runs"
    ours = run(runs, NEW)
    (runs / OLD).symlink_to(foreign)
    assert used_bytes(runs) == 3040
    delete_oldest(runs, max_bytes=1, keep=ours / "signals-0003.csv.gz")
    assert len(names(foreign)) == 7
    assert (runs / OLD).is_symlink()
    assert "signals-0003.csv.gz" in names(ours)


def test_a_folder_that_becomes_a_link_meanwhile_is_not_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    foreign = run(tmp_path / "foreign", OLD)
    runs = tmp_path / "runs"
    ours, old = run(runs, NEW), run(runs, OLD)
    opened = os.open

    def late(path: Any, flags: int, *more: Any, **others: Any) -> int:
        if Path(path) == old and not old.is_symlink():
            old.rename(runs / "moved")
            old.symlink_to(foreign)
        return opened(path, flags, *more, **others)

    monkeypatch.setattr(os, "open", late)
    delete_oldest(runs, max_bytes=1, keep=ours / "signals-0003.csv.gz")
    assert old.is_symlink()
    assert len(names(foreign)) == 7


@pytest.mark.parametrize("mark", ["nothing", "a folder", "a link"])
def test_a_folder_without_the_mark_of_a_run_is_left_alone(tmp_path: Path, mark: str) -> None:
    runs = tmp_path / "runs"
    other, ours = run(runs, OLD), run(runs, NEW)
    (other / "run.yaml").unlink()
    if mark == "a folder":
        (other / "run.yaml").mkdir()
    elif mark == "a link":
        (other / "run.yaml").symlink_to(ours / "run.yaml")
    before = names(other)
    delete_oldest(runs, max_bytes=1, keep=ours / "signals-0003.csv.gz")
    assert names(other) == before


def test_links_inside_a_run_are_taken_away_and_not_what_they_lead_to(tmp_path: Path) -> None:
    target = tmp_path / "precious"
    target.write_bytes(bytes(5000))
    runs = tmp_path / "runs"
    old, ours = run(runs, OLD, 0), run(runs, NEW)
    (old / "signals-0001.csv.gz").symlink_to(target)
    (old / "events.csv").unlink()
    (old / "events.csv").symlink_to(target)
    assert used_bytes(runs) < 5000
    delete_oldest(runs, max_bytes=1, keep=ours / "signals-0003.csv.gz")
    assert not old.exists()
    assert target.stat().st_size == 5000


def test_what_somebody_put_into_a_run_stays_with_its_mark_gone_last(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    old, ours = run(runs, OLD), run(runs, NEW)
    (old / "notes.txt").write_text("mine")
    delete_oldest(runs, max_bytes=1, keep=ours / "signals-0003.csv.gz")
    assert names(old) == ["notes.txt"]


def test_a_large_file_that_somebody_put_into_a_run_costs_no_other_record(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    old, ours = run(runs, OLD), run(runs, NEW)
    (old / "export.mf4").write_bytes(bytes(50_000))
    delete_oldest(runs, max_bytes=7000, keep=ours / "signals-0003.csv.gz")
    assert len(names(old)) == 8
    assert len(names(ours)) == 7


def test_a_clock_that_was_set_back_does_not_make_the_present_run_the_oldest(
    tmp_path: Path,
) -> None:
    runs = tmp_path / "runs"
    present, before = run(runs, "19700101T000012Z_line"), run(runs, OLD)
    delete_oldest(runs, max_bytes=4000, keep=present / "signals-0003.csv.gz")
    assert len(names(present)) == 7
    assert "signals-0001.csv.gz" not in (names(before) if before.exists() else [])


def test_a_link_to_nowhere_with_the_name_of_the_new_run_is_not_followed(tmp_path: Path) -> None:
    runs, target = tmp_path / "runs", tmp_path / "later"
    runs.mkdir()
    (runs / "20260101T000000Z_line").symlink_to(target)
    folder = RunFolder(runs, head_of(RunMeta(), "2026-01-01T00:00:00"), RunContext(name="line"))
    assert folder.path.name == "20260101T000000Z_line-2"
    assert folder.files_lost == 0
    assert not target.exists()


# --- files that are replaced ------------------------------------------------------------------


def test_a_link_laid_for_the_new_file_is_not_followed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    victim = tmp_path / "victim"
    victim.write_text(SECRET)
    (tmp_path / ".roll.html.new").symlink_to(victim)  # the name before it was by chance
    replace_text(tmp_path / "roll.html", "page")
    assert victim.read_text() == SECRET
    monkeypatch.setattr(files.secrets, "token_hex", lambda _: "guessed")
    (tmp_path / ".roll.html.guessed.new").symlink_to(victim)
    with pytest.raises(FileExistsError):
        replace_text(tmp_path / "roll.html", "page again")
    assert victim.read_text() == SECRET
    assert (tmp_path / "roll.html").read_text() == "page"


def test_two_names_are_never_the_same(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[str] = []
    opened = os.open

    def watched(path: Any, flags: int, *more: Any) -> int:
        if flags & os.O_CREAT:
            seen.append(str(path))
            assert flags & os.O_EXCL
            assert flags & os.O_NOFOLLOW
        return opened(path, flags, *more)

    monkeypatch.setattr(os, "open", watched)
    for _ in range(20):
        replace_text(tmp_path / "x.json", "text")
    assert len(set(seen)) == 20
    assert names(tmp_path) == ["x.json"]


def test_a_link_in_the_place_of_the_file_is_replaced_itself(tmp_path: Path) -> None:
    victim = tmp_path / "victim"
    victim.write_text(SECRET)
    victim.chmod(0o600)
    path = tmp_path / "x.json"
    path.symlink_to(victim)
    replace_text(path, "text")
    assert victim.read_text() == SECRET
    assert not path.is_symlink()
    assert path.read_text() == "text"


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664])
def test_the_mode_of_a_file_is_kept(tmp_path: Path, mode: int) -> None:
    path = tmp_path / "x.json"
    path.write_text("old")
    path.chmod(mode)
    replace_text(path, "new")
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert path.read_text() == "new"


def test_a_new_file_has_the_mode_that_the_umask_leaves(tmp_path: Path) -> None:
    before = os.umask(0o027)
    try:
        replace_text(tmp_path / "learned" / "x.json", "new")
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / "learned" / "x.json").stat().st_mode) == 0o640


def test_file_and_name_are_on_the_disk_before_it_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    done: list[str] = []
    synced, replaced = os.fsync, Path.replace

    def fsync(descriptor: int) -> None:
        done.append("folder" if stat.S_ISDIR(os.fstat(descriptor).st_mode) else "file")
        synced(descriptor)

    def replace(path: Path, target: Path) -> Path:
        done.append("replaced")
        return replaced(path, target)

    monkeypatch.setattr(os, "fsync", fsync)
    monkeypatch.setattr(Path, "replace", replace)
    replace_text(tmp_path / "x.json", "text")
    assert done == ["file", "replaced", "folder"]


def test_a_failed_write_leaves_nothing_and_the_old_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "x.json"
    path.write_text("old")

    def full(_: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        replace_text(path, "new")
    assert names(tmp_path) == ["x.json"]
    assert path.read_text() == "old"
