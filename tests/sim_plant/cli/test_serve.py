"""The command in a process of its own, with a fake line in place of the compiled one."""

import signal
import subprocess
import sys

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.cli.main import build_parser, main
from sim_plant.cli.serve import read_options
from sim_plant.servers.faults import Fault
from tests.sim_plant.servers.fake_line import REPOSITORY

pytestmark = pytest.mark.processes

PROGRAM = """
import sys
from tests.sim_plant.servers.no_kernel import opened_by
def open_line(path, *, seed, speed_m_s):
    from tests.sim_plant.servers.fake_line import FakeLine
    assert (str(path), seed, speed_m_s) == ("line.yaml", 7, 1.5)
    return FakeLine(0.02)
opened_by(open_line)
from sim_plant.cli.main import main
sys.exit(main(sys.argv[1:]))
"""
OPENING = (
    "opening line.yaml: the first start compiles the line's model, which takes some ten seconds"
)
ARGUMENTS = ["serve", "line.yaml", "--seed", "7", "--speed-m-s", "1.5", "--no-realtime"]


def options(*words):
    return read_options(build_parser().parse_args(["serve", "line.yaml", *words]))


def test_the_defaults_are_loopback_and_no_faults():
    chosen = options()
    assert (chosen.host, chosen.port, chosen.faults) == ("127.0.0.1", 5020, ())
    assert chosen.allow_fc23
    assert chosen.realtime


def test_words_of_the_command_become_options():
    chosen = options(
        "--modbus",
        "localhost:6000",
        "--fault",
        "mute@1",
        "--fault",
        "busy",
        "--no-fc23",
        "--duration",
        "3",
    )
    assert (chosen.host, chosen.port, chosen.duration_s) == ("localhost", 6000, 3.0)
    assert [spec.fault for spec in chosen.faults] == [Fault.MUTE, Fault.BUSY]
    assert not chosen.allow_fc23


def test_a_speed_is_taken_in_m_s_or_with_its_unit():
    def speed(*words: str) -> float:
        return build_parser().parse_args(["serve", "line.yaml", *words]).speed_m_s

    assert speed("--speed-m-s", "1.5") == 1.5
    assert speed("--speed-m-s", "200 FPM") == pytest.approx(200 * 0.3048 / 60)


def test_a_speed_in_a_unit_of_something_else_is_refused(capsys):
    with pytest.raises(SystemExit, match="2"):
        build_parser().parse_args(["serve", "line.yaml", "--speed-m-s", "3 N"])
    assert "expected a speed" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--modbus", "5020"], "write HOST:PORT"),
        (["--modbus", "h:70000"], "write HOST:PORT"),
        (["--fault", "melt"], "unknown name"),
        (["--duration", "-1"], "write seconds"),
        (["--duration", "nan"], "write seconds"),
        (["--stepped"], "write --control PATH too"),
    ],
)
def test_a_misspelt_option_exits_with_code_2_and_says_what_to_write(capsys, words, said):
    assert main(["serve", "line.yaml", *words]) == 2
    assert said in capsys.readouterr().err


@pytest.mark.wire
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
@pytest.mark.sweep(every=2)
def test_the_command_says_ready_and_stops_cleanly_on_a_signal(number):
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM, *ARGUMENTS, "--modbus", "127.0.0.1:0"],
        cwd=REPOSITORY,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            ready = process.stdout.readline()
            process.send_signal(number)
            out, err = process.communicate(timeout=20)
        finally:
            process.kill()
    assert ready.startswith("ready modbus 127.0.0.1:")
    assert (process.returncode, out) == (0, "")
    assert err == ""


@pytest.mark.parametrize("cold", [True, False])
def test_what_takes_long_at_the_first_start_is_said_then_and_before_it(capsys, monkeypatch, cold):
    """The line is opened, and so compiled, after the words; they must not wait in a buffer."""
    import sim_plant.line
    from sim_plant.base import jit

    before = []

    def open_line(*_, **__):
        before.append(capsys.readouterr().err)
        raise PlantError("enough")

    monkeypatch.setattr(sim_plant.line, "open_line", open_line)
    monkeypatch.setattr(jit, "nothing_kept", lambda: cold)
    assert main(["serve", "line.yaml"]) == PlantError.exit_code
    assert before == [(OPENING + "\n") * cold]


def test_code_is_kept_once_something_was_compiled(tmp_path, monkeypatch):
    from sim_plant.base import jit

    monkeypatch.setattr(jit, "_FOLDER", tmp_path)
    assert jit.nothing_kept()
    (tmp_path / "line_1").mkdir()
    (tmp_path / "line_1" / "kernel.1.nbc").touch()
    assert not jit.nothing_kept()
    monkeypatch.setattr(jit, "_FOLDER", None)
    assert jit.nothing_kept()
