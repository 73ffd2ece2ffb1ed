"""A gateway keeps its records in a folder that only the service's user and root may look into."""

from __future__ import annotations

import tempfile
from pathlib import Path

import pytest

from aff_runtime.base.files import CLOSED_TEXT
from aff_runtime.base.runs.window import MARK
from aff_runtime.cli.main import main
from tests.aff_runtime.config.shipped import EUCLID
from tests.closed_folder import closed

TWICE = "{}@0..10 {}@20..30"
COMMANDS = {
    "compare": f"compare {TWICE}",
    "compare whole runs": "compare {} {}",
    "export": "export {} --out x.parquet",
    "watch trend": "watch trend {}",
}


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_what_may_not_be_looked_at_is_told_from_what_is_not_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    house = tmp_path / "house"
    (house / "there").mkdir(parents=True)
    (house / "there" / MARK).write_text("columns: [time_s]\n")

    def said_of(name: str) -> str:
        path = house / name
        assert main(words.format(path, path).split()) in (1, 2)
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith(f"aff-runtime: {path}: ")
        return line.removeprefix(f"aff-runtime: {path}: ")

    assert CLOSED_TEXT not in said_of("nowhere")
    with closed(house):
        assert said_of("there") == CLOSED_TEXT
        assert said_of("nowhere") == CLOSED_TEXT  # nobody can know


def test_a_run_whose_file_alone_is_closed_is_not_said_to_be_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / MARK).write_text("columns: [time_s]\n")
    words = ["compare", str(tmp_path), str(tmp_path)]
    main(words)
    capsys.readouterr()
    with closed(tmp_path / MARK):
        assert main(words) == 1
    assert CLOSED_TEXT in capsys.readouterr().err


@pytest.mark.parametrize("words", ["watch add {}/store {}/runs", "audit verify {}/audit.jsonl"])
def test_a_file_that_a_command_did_not_reckon_with_is_named_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: str
) -> None:
    house = tmp_path / "house"
    (house / "runs").mkdir(parents=True)
    given = words.replace("{}", str(house)).split()
    main(given)
    capsys.readouterr()
    with closed(house):
        assert main(given) in (1, 2)
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith(f"aff-runtime: {house}/")
    assert line.endswith(CLOSED_TEXT)


def test_check_says_that_responses_behind_a_closed_folder_are_not_checked(
    capsys: pytest.CaptureFixture[str],
) -> None:
    """As `install.sh` lays it: the folder of what is learned is a link into the service's own."""
    with tempfile.TemporaryDirectory() as name:
        etc = Path(name)
        etc.chmod(0o755)  # pytest's own folders are closed to others
        site, house = etc / "site.yaml", etc / "house"
        site.write_text(EUCLID.read_text())
        (house / "learned").mkdir(parents=True)
        (etc / "learned").symlink_to(house / "learned")
        words = ["check", "--brief", "--state-dir", str(house), str(site)]
        assert main(words) == 0
        assert "not checked" not in capsys.readouterr().out
        with closed(house):
            assert main(words) == 0
    said = [line for line in capsys.readouterr().out.splitlines() if "is not checked" in line]
    assert len(said) == 2  # one of each actuator
    assert all("Permission denied" in line for line in said)
