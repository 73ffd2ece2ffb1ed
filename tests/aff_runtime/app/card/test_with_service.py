"""The card on the console beside a running service, on a real wire.

Without one: ``measure/`` and ``tests/aff_runtime/cli/test_card.py``.
"""

import re

import pytest

from aff_runtime.cli.main import main
from tests.aff_runtime.app.service_run import ServiceRun
from tests.processes import until

pytestmark = [pytest.mark.long, pytest.mark.wire]


@pytest.fixture(scope="module")
def service(tmp_path_factory):
    run = ServiceRun(tmp_path_factory.mktemp("service"), "--state-dir", "/nowhere")
    until("eleven seconds are recorded", lambda: run.status()["signals"]["time_s"] > 11.0)
    yield run
    run.close()


@pytest.fixture
def card(service, tmp_path):
    """The command on a card that is begun."""
    assert main(["card", "new", str(service.site), str(tmp_path)]) == 0
    options = ["--card", str(tmp_path), "--runtime-dir", str(service.runtime_dir)]
    return lambda *words: main(["card", *words, *options])


def test_steps_are_measured_from_what_the_service_records_and_is(service, card, capsys, tmp_path):
    signals = service.status()["signals"]
    names = ("unwind_tension_N", "pullroll_tension_N", "line_speed_m_s", "unwind_radius_m")
    typed = [word for name in names for word in ("--typed", f"{name}={signals[name]}")]
    code = card("step", "2", *typed)
    said = capsys.readouterr().out
    assert "heartbeat: longest rest" in said
    assert code == (5 if "FAIL" in said else 0)
    run = service.status()["recorder"]["folder"]
    assert card("step", "0", "--run", f"{run}@1..6") == 5  # that is no minute
    said = capsys.readouterr().out
    assert re.search(r"(ok|FAIL|-) +SCHED_FIFO granted", said)
    assert "wake-up, 99 % point" in said
    assert card("step", "10") == 0
    assert "the correction is not on: the service is" in capsys.readouterr().out
    assert card("show") == 0
    said = capsys.readouterr()
    assert said.err == ""
    assert main(["card", "verify", str(tmp_path), "--records"]) == 0


def test_a_service_on_other_settings_than_the_file_says_is_no_source(service, card, capsys):
    text = service.site.read_text()
    other = service.folder / "other.yaml"
    other.write_text(text.replace("limit_m_s: 0.05", "limit_m_s: 0.045"))
    assert card("step", "10", "--site", str(other)) == 4
    assert "the service runs on other settings" in capsys.readouterr().err
