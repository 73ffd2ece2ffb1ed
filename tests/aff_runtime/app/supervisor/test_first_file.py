"""A service that is installed before its line is commissioned waits for a good site file."""

from __future__ import annotations

import logging
from pathlib import Path

import pytest

from aff_runtime.app.supervisor import first_file
from aff_runtime.app.supervisor.first_file import await_site
from aff_runtime.base.errors import ConfigError
from tests.doubles.virtual_clock import VirtualClock


class Days(VirtualClock):
    """A clock on which somebody saves texts, one a look."""

    def __init__(self, site: Path, texts: list[str]) -> None:
        super().__init__(1)
        self.site, self.texts = site, texts

    def sleep_until_ns(self, deadline_ns: int) -> None:
        super().sleep_until_ns(deadline_ns)
        if self.texts and (text := self.texts.pop(0)):
            self.site.write_text(text)


@pytest.fixture
def checked(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What was checked; only ``good`` is."""
    found: list[str] = []

    def load(site: Path, state: Path) -> None:
        found.append(site.read_text())
        if found[-1] != "good":
            raise ConfigError("1:1  is not good")

    monkeypatch.setattr(first_file, "load_parameters", load)
    return found


def test_a_file_that_is_there_and_good_is_waited_for_no_longer(
    tmp_path: Path, checked: list[str]
) -> None:
    site = tmp_path / "site.yaml"
    site.write_text("good")
    await_site(site, tmp_path, Days(site, []))
    assert checked == ["good"]


def test_one_that_comes_later_and_is_mended_is_looked_at_once_for_every_text(
    tmp_path: Path, checked: list[str], caplog: pytest.LogCaptureFixture
) -> None:
    site = tmp_path / "site.yaml"
    texts = ["", "", "worse and longer", "", "", "", "good", "", "", ""]
    with caplog.at_level(logging.INFO):
        await_site(site, tmp_path, Days(site, texts))
    assert checked == ["worse and longer", "good"]
    assert "not there yet; the service begins once it is" in caplog.text
    assert caplog.text.count("waits for a good site file") == 1
