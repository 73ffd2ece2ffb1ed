"""Runs are taken whole or not at all."""

import shutil

import pytest

from aff_runtime.app.report.watching import taking
from aff_runtime.app.report.watching.run_hours import run_hours
from aff_runtime.app.report.watching.store import load_store
from aff_runtime.base.errors import ConfigError
from tests.doubles.virtual_weeks import Weeks, write_weeks

WEEKS = Weeks(r6_m=lambda km, _: 4e-5 + 1e-8 * km)


class Torn:
    """A run of which the second hour cannot be read."""

    def __init__(self, run):
        self._run = run
        self._read = 0

    def __getattr__(self, name):
        return getattr(self._run, name)

    def read(self, hour):
        self._read += 1
        if self._read == 2:
            raise ConfigError("segment 2 is torn")
        return self._run.read(hour)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    return list(write_weeks(WEEKS, tmp_path_factory.mktemp("runs"), range(2)))


def take(folder, runs, said):
    return taking.take_runs(folder, runs, said.append, said.append)


def test_a_run_that_fails_in_the_middle_leaves_the_store_as_it_was(runs, tmp_path, monkeypatch):
    said = []
    take(tmp_path / "store", runs[:1], said)
    before = load_store(tmp_path / "store")
    monkeypatch.setattr(taking, "run_hours", lambda folder: Torn(run_hours(folder)))
    found = take(tmp_path / "store", runs[1:], said)
    assert (found.runs, found.refused) == (1, 1)
    assert "segment 2 is torn" in said[-1]
    after = load_store(tmp_path / "store")
    assert after.hours["hour"].tolist() == before.hours["hour"].tolist()
    assert after.orders["hour"].size == before.orders["hour"].size
    monkeypatch.undo()
    assert take(tmp_path / "store", runs[1:], said).refused == 0  # and it can be taken later


def test_a_first_run_that_fails_does_not_give_the_store_its_line(runs, tmp_path, monkeypatch):
    monkeypatch.setattr(taking, "run_hours", lambda folder: Torn(run_hours(folder)))
    found = take(tmp_path / "store", runs[:1], [])
    assert found.refused == 1
    assert found.store.line == ""


def test_what_is_wrong_with_the_files_of_an_hour_is_said(runs, tmp_path):
    run = shutil.copytree(runs[0], tmp_path / "run")
    first = sorted(run.glob("signals-*"))[0]
    content = bytearray(first.read_bytes())
    content[-8] ^= 1  # of its checksum
    first.write_bytes(content)
    said = []
    take(tmp_path / "store", [run], said)
    assert any(f"{first.name}: its checksum is not that of its rows" in text for text in said)


def test_a_run_with_the_site_file_of_another_line_is_left_out(runs, tmp_path):
    run = shutil.copytree(runs[0], tmp_path / "run")
    site = run / "site.yaml"
    site.write_text(site.read_text().replace("name: Weeks", "name: Film"))
    said = []
    found = take(tmp_path / "store", [run], said)
    assert (found.refused, found.store.line) == (1, "")
    assert "left out: " in said[-1]
    assert "its site.yaml is of line Film, its run.yaml of Weeks" in said[-1]
