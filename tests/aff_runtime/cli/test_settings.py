"""Saving what the service hands out: only over the file that is meant, and as it is."""

import hashlib
import stat

import pytest

from aff_runtime.app.commission.settings.saving import await_saved, save
from aff_runtime.app.link.answers import refusal
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.request_socket import RequestSocket
from aff_runtime.app.link.settings_answer import SettingsAnswer
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.cli.main import build_parser, main
from tests.doubles.virtual_clock import VirtualClock

FORMER, NEW = "a: 1  # mine\n", "a: 2  # mine \u00e4\n"


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()


@pytest.fixture
def site(tmp_path):
    path = tmp_path / "site.yaml"
    path.write_text(FORMER)
    path.chmod(0o640)
    return path


def handed_out(site, **given):
    return SettingsAnswer(
        **{"site": str(site), "text": NEW, "replaces": digest(FORMER), **given}  # type: ignore[arg-type]
    )


def test_the_text_is_saved_to_the_letter_and_the_mode_stays(site):
    save(site, handed_out(site))
    assert site.read_bytes() == NEW.encode()
    assert stat.S_IMODE(site.stat().st_mode) == 0o640


def test_a_file_that_the_caller_did_not_name_is_not_written(site, tmp_path):
    other = tmp_path / "other.yaml"
    other.write_text(FORMER)
    with pytest.raises(ConfigError, match="the service runs on"):
        save(other, handed_out(site))
    assert (other.read_text(), site.read_text()) == (FORMER, FORMER)


def test_a_file_that_was_saved_meanwhile_is_left_alone(site):
    site.write_text("a: 3\n")
    with pytest.raises(ConfigError, match="somebody has saved it meanwhile; nothing is kept"):
        save(site, handed_out(site))
    assert site.read_text() == "a: 3\n"


def test_a_file_that_is_gone_is_named(site):
    site.unlink()
    with pytest.raises(ConfigError, match=r"site\.yaml:1:1  cannot be read: No such file"):
        save(site, handed_out(site))


def test_it_waits_until_the_service_runs_on_what_was_saved():
    states = [
        SettingsAnswer(running=digest(FORMER), trying="yes"),
        SettingsAnswer(running=digest(NEW), trying="yes"),
        SettingsAnswer(running=digest(NEW)),
    ]
    asked = iter(states)
    await_saved(lambda: next(asked), NEW, VirtualClock())
    assert list(asked) == []
    with pytest.raises(RefusedError, match="it is saved and does not run yet"):
        await_saved(lambda: states[0], NEW, VirtualClock())


def test_a_change_needs_its_reason(capsys):
    for words in (["try", "new.yaml"], ["keep", "site.yaml"], ["undo", "site.yaml"]):
        with pytest.raises(SystemExit):
            build_parser().parse_args(["settings", *words])
        assert "--why" in capsys.readouterr().err


def test_what_is_wrong_with_new_settings_comes_a_line_each_and_says_whose_lines(
    tmp_path, monkeypatch, capsys
):
    (tmp_path / "run").mkdir(mode=0o700)
    service = RequestSocket(tmp_path / "run" / "control.sock")
    client = ServiceClient(tmp_path / "run" / "control.sock")
    monkeypatch.setattr("aff_runtime.cli.settings.connect", lambda _options: client)
    caller = service.accept()
    assert caller is not None
    found = "/etc/site.yaml:3:1  limit_m_s: too large\n/etc/site.yaml:9:1  \x1b[2Jodd"
    caller.send(refusal(ConfigError(found)))
    new = tmp_path / "new.yaml"
    new.write_text(NEW)
    try:
        assert main(["settings", "diff", str(new)]) == 2
    finally:
        service.close()
    first, second, whose = capsys.readouterr().err.splitlines()
    assert first.endswith("/etc/site.yaml:3:1  limit_m_s: too large")
    assert second == r"/etc/site.yaml:9:1  \x1b[2Jodd"
    assert whose == f"lines and columns are those of {new}"
