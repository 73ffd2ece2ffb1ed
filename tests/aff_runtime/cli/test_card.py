"""The card on the console: exit codes, and what a person types; no service runs here."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from aff_runtime.app.commission import paths
from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.cli.main import main
from tests.aff_runtime.app.card.measure.recorded import SITE_FILE, recorded, steady
from tests.aff_runtime.app.judged_here import judged_here

ROOT = Path(__file__).parents[3]
WHY = "checked on the drive"


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """A record of 12 s; nobody changes it."""
    columns = steady(12.0)
    columns["unwind_tension_N"] += np.sin(40.0 * columns["time_s"])
    return recorded(tmp_path_factory.mktemp("runs"), columns)


@pytest.fixture
def line(tmp_path, monkeypatch, run):
    """A site file, a card of it, a record; and the command with its options.

    The site file is checked here, not in a process for each command; the process is asked in
    `test_a_step_is_measured_signed_printed_and_verified`.
    """
    monkeypatch.setattr(paths, "load_parameters", judged_here)
    site, card = tmp_path / "site.yaml", tmp_path / "card"
    shutil.copyfile(SITE_FILE, site)
    assert main(["card", "new", str(site), str(card)]) == 0

    def act(*words):
        options = ["--card", str(card), "--runtime-dir", str(tmp_path / "none")]
        return main(["card", *words, *options])

    act.card, act.site, act.run = card, site, run
    return act


def test_a_step_is_measured_signed_printed_and_verified(line, capsys, monkeypatch):
    with monkeypatch.context() as patched:
        patched.setattr(paths, "load_parameters", load_parameters)
        assert line("step", "4", "--typed", "reaction=ramp", "--typed", "time=120 ms") == 0
    assert "step 4: pass" in capsys.readouterr().out
    assert line("sign", "4", "--as", "Ada Miller", "--reason", WHY) == 0
    newest = capsys.readouterr().out.split()[-1]
    assert line("show") == 0
    said = capsys.readouterr()
    assert "signed as Ada Miller" in said.out
    assert "no service answers: roll not compared" in said.err
    assert line("page") == 0
    assert newest in (line.card / "card.html").read_text()
    file = str(line.card / "card.jsonl")
    assert main(["card", "verify", file, "--newest", newest]) == 0
    assert f"3 entries, whole; newest {newest}" in capsys.readouterr().out


def test_a_limit_that_is_not_kept_is_exit_code_5(line, capsys):
    assert line("step", "4", "--typed", "reaction=hold", "--typed", "time=1 ms") == 5
    assert "FAIL  reaction of the watchdog: hold" in capsys.readouterr().out


def test_what_is_missing_is_said_for_every_reader_and_the_console_says_how(line, capsys):
    assert line("step", "4") == 0
    said = capsys.readouterr().out
    assert "missing   type how long it took: time=120 ms\n" in said
    assert "          what is typed: --typed 'NAME=VALUE UNIT', once for each\n" in said
    assert line("step", "1", "--run", f"{line.run}@2..12") == 2
    said = capsys.readouterr().err
    assert "step 1: type the load that hangs there: load=0, or load=20 lbf; what is " in said


def test_no_measurement_speaks_of_the_console_alone():
    """Its sentences are shown at the screen, and stand on the card."""
    files = list((ROOT / "aff_runtime" / "app" / "card" / "measure").glob("*.py"))
    assert len(files) > 10
    for file in files:
        assert not re.search(r"--typed|--run|SITE\.yaml", file.read_text(encoding="utf-8")), file


def test_a_step_of_the_record_names_its_window_and_its_segments(line, capsys, tmp_path):
    run = shutil.copytree(line.run, tmp_path / "run")
    words = ["--typed", "load=0", "--typed", "signal=unwind_tension_N"]
    assert line("step", "1", "--run", f"{run}@2..12", *words) == 0
    card = str(line.card)
    assert main(["card", "verify", card, "--records"]) == 0
    segment = next(run.glob("signals-*"))
    content = segment.read_bytes()
    segment.write_bytes(content + b"more")  # the recorder went on
    assert main(["card", "verify", card, "--records"]) == 0
    segment.write_bytes(content[:-9] + b"x" * 9)
    assert main(["card", "verify", card, "--records"]) == 5
    assert "are not what they were" in capsys.readouterr().err
    assert main(["card", "verify", card]) == 0


def test_a_broken_chain_says_which_entry_and_how(line, capsys):
    assert line("step", "4", "--typed", "reaction=zero", "--typed", "time=1 ms") == 0
    path = line.card / "card.jsonl"
    path.write_bytes(path.read_bytes().replace(b'"text":"zero"', b'"text":"Zero"'))
    assert main(["card", "verify", str(line.card)]) == 5
    assert "does not hold: entry 2: its content does not have its hash" in capsys.readouterr().err
    assert line("show") == 2
    assert line("step", "4") == 2


def test_entries_that_were_taken_away_are_found_by_the_pages_hash(line, capsys):
    path = line.card / "card.jsonl"
    before = path.read_bytes()
    assert line("step", "4", "--typed", "reaction=zero", "--typed", "time=1 ms") == 0
    assert main(["card", "verify", str(path)]) == 0
    newest = capsys.readouterr().out.split()[-1]
    path.write_bytes(before)
    assert main(["card", "verify", str(path), "--newest", newest]) == 5
    assert "entries were taken away" in capsys.readouterr().err


def test_another_site_file_turns_a_step_to_again_and_nothing_is_signed(line, capsys):
    words = ["--typed", "unwind=0.05 m/s", "--typed", "swrap_follower=0.04 m/s"]
    warnings = line.site.read_text()
    assert line("step", "3", *words) in (0, 5)
    line.site.write_text(warnings.replace("limit_m_s: 0.05", "limit_m_s: 0.045"))
    assert line("show") == 0
    assert "again (site file, limits and ramps of the actuators: " in capsys.readouterr().out
    assert line("sign", "3", "--as", "Ada", "--reason", WHY) == 4
    assert "step 3 is again" in capsys.readouterr().err


def test_another_program_of_the_plc_turns_the_watchdog_to_again(line, capsys):
    words = ["step", "4", "--typed", "reaction=zero", "--typed", "time=1 ms", "--plc"]
    assert line(*words, "3.1") == 0
    assert line("step", "3", "--plc", "3.2") == 0
    assert line("show") == 0
    assert "again (program of the PLC: 3.1, now 3.2)" in capsys.readouterr().out


def test_a_step_that_does_not_apply_has_a_reason_and_can_be_signed(line, capsys):
    assert line("step", "4", "--not-applicable", "short") == 2
    assert line("step", "4", "--not-applicable", "the gateway has no watchdog") == 0
    assert line("sign", "4", "--as", "Ada", "--reason", WHY) == 0
    assert line("show") == 0
    assert "not applicable  signed as Ada" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "code", "said"),
    [
        (["step", "13"], 4, "no step 13"),
        (["step", "2"], 4, "--run RUN_DIR@FROM..TO"),
        (["step", "4", "--run", "x@1..2"], 2, "looks at no record"),
        (["step", "4", "--typed", "colour=red"], 2, "does not ask for it"),
        (["step", "4", "--typed", "colour"], 2, "expected name=value"),
        (["sign", "4", "--as", "Ada", "--reason", WHY], 4, "step 4 is not measured"),
        (["step", "1", "--run", "/nowhere@1..2"], 1, "not a run folder"),
    ],
)
def test_what_cannot_be_done_says_why_and_adds_nothing(line, capsys, words, code, said):
    before = (line.card / "card.jsonl").read_bytes()
    assert line(*words) == code
    assert said in capsys.readouterr().err
    assert (line.card / "card.jsonl").read_bytes() == before


def test_a_record_of_other_settings_is_refused(line, tmp_path, capsys):
    other = SITE_FILE.read_text().replace("limit_m_s: 0.05", "limit_m_s: 0.045")
    run = recorded(tmp_path / "others", steady(12.0), site_text=other)
    assert line("step", "1", "--run", str(run), "--typed", "load=0") == 4
    assert "recorded on other settings" in capsys.readouterr().err
    edited = recorded(tmp_path / "edited", steady(12.0), events=[(3.0, "EDIT")])
    assert line("step", "1", "--run", str(edited), "--typed", "load=0") == 4
    assert "settings were changed in it" in capsys.readouterr().err


def test_a_second_card_in_the_folder_and_a_bad_site_are_refused(line, tmp_path, capsys):
    assert main(["card", "new", str(line.site), str(line.card)]) == 4
    assert "there is a card already" in capsys.readouterr().err
    assert main(["card", "new", str(tmp_path / "none.yaml"), str(tmp_path / "b")]) == 2
    assert not (tmp_path / "b").exists()
    assert main(["card", "show", "--card", str(tmp_path / "b")]) == 2
