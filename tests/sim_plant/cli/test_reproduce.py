"""`sim-plant reproduce` writes a gallery for what was asked, or says what it knows."""

from pathlib import Path

import pytest

from sim_plant.cli.main import main


def test_one_experiment_makes_a_gallery_and_a_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    docs = tmp_path / "table.md"
    assert main(["reproduce", "--only", "T2.2", "--out", str(tmp_path), "--docs", str(docs)]) == 0
    assert "<svg" in (tmp_path / "reproduction.html").read_text(encoding="utf-8")
    assert "0.0127 lbf ft" in docs.read_text(encoding="utf-8")
    assert "gallery:" in capsys.readouterr().out


def test_an_unknown_experiment_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "--only", "7.1"]) == 2
    assert "no such experiment" in capsys.readouterr().err


def test_list_names_all(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["reproduce", "--list"]) == 0
    text = capsys.readouterr().out
    assert len(text.splitlines()) >= 34
    assert "6.accumulator" in text
