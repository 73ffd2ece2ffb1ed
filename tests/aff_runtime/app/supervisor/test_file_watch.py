"""An edit is noticed however the editor writes, and once."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from aff_runtime.app.supervisor.file_watch import FileWatch


@pytest.fixture
def site(tmp_path: Path) -> Path:
    path = tmp_path / "site.yaml"
    path.write_text("version: 1\n")
    return path


def looks(watch: FileWatch, n: int = 4) -> list[bool]:
    return [watch.changed() for _ in range(n)]


def test_an_untouched_file_never_counts_as_changed(site: Path) -> None:
    assert looks(FileWatch([site])) == [False] * 4


def test_a_write_in_place_counts_once_after_it_settled(site: Path) -> None:
    watch = FileWatch([site])
    site.write_text("version: 1\nline: {}\n")
    assert looks(watch) == [False, True, False, False]


def test_a_replacement_of_the_same_size_and_time_counts(site: Path) -> None:
    watch = FileWatch([site])
    known = site.stat()
    other = site.with_suffix(".new")
    other.write_text("version: 2\n")
    os.utime(other, ns=(known.st_atime_ns, known.st_mtime_ns))
    other.replace(site)
    assert looks(watch) == [False, True, False, False]


def test_a_file_that_keeps_growing_is_left_alone_until_it_rests(site: Path) -> None:
    watch = FileWatch([site])
    for k in range(3):
        with site.open("a") as file:
            file.write(f"# {k}\n")
        assert watch.changed() is False
    assert watch.changed() is True


def test_removal_and_return_of_the_same_contents_count(site: Path) -> None:
    watch = FileWatch([site])
    text = site.read_text()
    site.unlink()
    assert looks(watch, 3) == [False, True, False]
    site.write_text(text)
    assert looks(watch, 3) == [False, True, False]


def test_a_change_during_the_hand_over_of_the_one_before_is_not_lost(site: Path) -> None:
    watch = FileWatch([site])
    site.write_text("version: 1\nline: {}\n")
    assert looks(watch, 2) == [False, True]
    site.write_text("version: 1\nline: {name: other}\n")
    watch.watch([site, site.with_name("learned.json")])
    assert looks(watch) == [True, False, False, False]
