"""Each line's control process has a processor that nobody else has, as long as they last."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.security.installed_units import install, stub_in

UNITS = "etc/systemd/system"
Gateway = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def gateway(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Gateway:
    """Return the installer below ``tmp_path/root`` on a machine of so many processors."""
    stub = stub_in(tmp_path)
    (tmp_path / "bin").mkdir()
    monkeypatch.setenv("PATH", str(tmp_path / "bin"), prepend=":")

    def run(*options: str, processors: int = 8) -> subprocess.CompletedProcess[str]:
        nproc = tmp_path / "bin/nproc"
        nproc.write_text(f"#!/bin/sh\necho {processors}\n")
        nproc.chmod(0o755)
        done = install(tmp_path / "root", *options, python=stub)
        assert done.returncode == 0, done.stderr
        return done

    return run


def enable(root: Path) -> None:
    """Do what ``systemctl enable aff-runtime`` does."""
    wants = root / UNITS / "multi-user.target.wants"
    wants.mkdir(parents=True, exist_ok=True)
    (wants / "aff-runtime.service").symlink_to("../aff-runtime.service")


def given(root: Path) -> dict[str, str]:
    """Return the processors that each unit may use."""
    return {
        path.parent.name.removesuffix(".service.d"): path.read_text().partition("=")[2].strip()
        for path in (root / UNITS).glob("*/cpu.conf")
    }


def test_two_named_lines_have_a_processor_each(gateway: Gateway, tmp_path: Path) -> None:
    gateway("--line", "film1", "--line", "film2")
    assert given(tmp_path / "root") == {"aff-runtime@film1": "0-7", "aff-runtime@film2": "0-6"}


def test_a_line_beside_the_unnamed_service_does_not_get_its_processor(
    gateway: Gateway, tmp_path: Path
) -> None:
    """The unnamed service may use all and ticks on the last, 7."""
    enable(tmp_path / "root")
    gateway("--line", "film2")
    assert given(tmp_path / "root") == {"aff-runtime@film2": "0-6"}


def test_the_place_of_a_line_that_was_taken_away_is_given_again_and_no_other(
    gateway: Gateway, tmp_path: Path
) -> None:
    root = tmp_path / "root"
    gateway("--line", "a", "--line", "b", "--line", "c")
    shutil.rmtree(root / UNITS / "aff-runtime@b.service.d")
    shutil.rmtree(root / "etc/aff-runtime/lines/b")
    gateway("--line", "d", "--line", "e")
    last = {"a": 7, "c": 5, "d": 6, "e": 4}
    assert given(root) == {f"aff-runtime@{line}": f"0-{n}" for line, n in last.items()}


def test_an_update_gives_no_other_processor(gateway: Gateway, tmp_path: Path) -> None:
    root = tmp_path / "root"
    gateway("--line", "b")
    gateway("--line", "a")
    before = given(root)
    gateway()
    assert given(root) == before == {"aff-runtime@b": "0-7", "aff-runtime@a": "0-6"}


def test_screen_commissioner_and_watch_stay_below_every_line(
    gateway: Gateway, tmp_path: Path
) -> None:
    enable(tmp_path / "root")
    gateway("--hmi", "--records")
    alone = given(tmp_path / "root")
    assert alone == dict.fromkeys(("aff-hmi", "aff-commission", "aff-watch"), "0-6")
    gateway("--line", "film2", "--line", "film3")
    assert given(tmp_path / "root") == {
        "aff-runtime@film2": "0-6",
        "aff-runtime@film3": "0-5",
    } | dict.fromkeys(alone, "0-4")


def test_a_dry_run_says_what_an_installation_does(gateway: Gateway, tmp_path: Path) -> None:
    said = gateway("--dry-run", "--line", "a", "--line", "b", "--hmi").stdout.splitlines()
    rows = [row.split("CPUAffinity=")[1].split(" > ") for row in said if "CPUAffinity" in row]
    found = {Path(path).parent.name.removesuffix(".service.d"): words for words, path in rows}
    gateway("--line", "a", "--line", "b", "--hmi")
    assert found == given(tmp_path / "root")
    assert found["aff-runtime@a"] != found["aff-runtime@b"]


def test_too_few_processors_are_said(gateway: Gateway, tmp_path: Path) -> None:
    """Of two, 1 is for a line and 0 has the interrupts."""
    done = gateway("--line", "a", "--line", "b", processors=2)
    assert given(tmp_path / "root") == {"aff-runtime@a": "0-1"}
    assert "no processor of its own is left for line b, of 2" in done.stderr
    assert gateway("--line", "a", processors=2).stderr.count("line a") == 0


def test_a_line_that_was_given_the_unnamed_services_processor_is_named(
    gateway: Gateway, tmp_path: Path
) -> None:
    root = tmp_path / "root"
    gateway("--line", "film2")
    enable(root)
    done = gateway()
    own = root / UNITS / "aff-runtime@film2.service.d/cpu.conf"
    assert f"two control processes tick on processor 7: for a free one remove {own}" in done.stderr
    own.unlink()
    assert gateway().stderr == ""
    assert given(root) == {"aff-runtime@film2": "0-6"}


@pytest.mark.parametrize("words", ["3", "0 3", "0-1,3", "0-3 "])
def test_what_a_technician_wrote_is_read_by_its_last_processor(
    words: str, gateway: Gateway, tmp_path: Path
) -> None:
    own = tmp_path / "root" / UNITS / "aff-runtime@mine.service.d"
    own.mkdir(parents=True)
    (own / "cpu.conf").write_text(f"[Service]\nCPUAffinity={words}\n")
    gateway("--line", "mine", "--line", "other", processors=4)
    assert given(tmp_path / "root") == {
        "aff-runtime@mine": words.strip(),
        "aff-runtime@other": "0-2",
    }
