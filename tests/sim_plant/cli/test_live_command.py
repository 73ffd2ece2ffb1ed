"""What the demo says at its end shows the very line that it ran."""

from __future__ import annotations

import argparse
import shlex
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.cli import demo, live
from sim_plant.cli.demo import ROOT, live_command, plan_of
from sim_plant.demo.unusual_plants import LINE, PLANTS
from sim_plant.servers.map_file import load_plc_map
from tests.each_case import each_case

needs_make = pytest.mark.skipif(shutil.which("make") is None, reason="make is needed")
RUNS = [
    "",
    "WIRE=can",
    "WIRE=canopen",
    "LINE=film",
    "LINE=film WIRE=can",
    "SPEED=300 LIMIT=0.3",
    "LAW=blocks",
    "LINE=film SPEED=2500 WIRE=can",
]


def parsed(command: list[str]) -> argparse.Namespace:
    parser = argparse.ArgumentParser()
    subparsers = parser.add_subparsers()
    demo.register(subparsers)
    live.register(subparsers)
    return parser.parse_args(command)


def recipe(asked: str, name: str) -> argparse.Namespace:
    """Return the arguments that a target of the Makefile would run a command with."""
    said = subprocess.run(
        shlex.split(asked), check=True, capture_output=True, text=True, cwd=ROOT
    ).stdout.replace("\\\n", " ")
    (line,) = [one for one in said.splitlines() if f"sim_plant.cli.main {name} " in one]
    return parsed(shlex.split(line)[3:])


@needs_make
@pytest.mark.parametrize("given", RUNS)
def test_the_command_after_a_demo_runs_the_same_line_by_the_same_wire(
    given: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(ROOT)
    shown = recipe(f"make -n demo {given}", "demo")
    command = live_command(shown)
    assert command.startswith("make hmi")
    looked_at = recipe(command.replace("make hmi", "make -n hmi"), "live")
    wanted, found = plan_of(shown), plan_of(looked_at)
    assert found.line_speed_m_s == pytest.approx(wanted.line_speed_m_s, rel=1e-5)
    names = ("line", "wire", "limit_m_s")
    assert [getattr(found, n) for n in names] == [getattr(wanted, n) for n in names]
    assert found.site.resolve() == wanted.site.resolve()


def test_it_is_as_short_as_what_was_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    assert live_command(parsed(["demo"])) == "make hmi"
    film = ["demo", "--machine", "film", "--wire", "can", "--speed-fpm", "1968.5"]
    assert live_command(parsed(film)) == "make hmi LINE=film WIRE=can"


def test_of_a_line_file_of_ones_own_and_elsewhere_it_is_the_command_itself(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.chdir(ROOT)
    own = parsed(["demo", "--line", "my line.yaml", "--speed-fpm", "250"])
    command = shlex.split(live_command(own))
    assert command[:2] == ["sim-plant", "live"]
    assert replace(plan_of(parsed(command[1:])), out=Path()) == replace(plan_of(own), out=Path())
    monkeypatch.chdir(tmp_path)
    assert live_command(parsed(["demo", "--wire", "can"])) == "sim-plant live --wire can"


@pytest.mark.parametrize(
    "asked", [["--wire", "canopen", "--machine", "film"], ["--speed-fpm", "5"]]
)
def test_what_is_no_line_of_ours_is_refused(asked: list[str]) -> None:
    for name in ("demo", "live"):
        with pytest.raises(PlantError, match=r"--wire canopen|--speed-fpm 5"):
            plan_of(parsed([name, *asked]))


@each_case(
    ("asked", "said"),
    [
        (["--plant", "CANopen"], "write --fresh too"),
        (["--fresh", "--plant", "high words"], "known are shipped, low words first, "),
        (["--fresh", "--plant", "CANopen", "--wire", "can"], "reached by --wire canopen"),
        (["--fresh", "--plant", "shipped", "--limit-m-s", "0.3"], "leave --limit-m-s out"),
    ],
)
def test_a_plant_to_commission_that_cannot_be_is_refused(asked: list[str], said: str) -> None:
    with pytest.raises(PlantError, match=said):
        live.run(parsed(["live", *asked]))


def test_a_plant_to_commission_brings_its_wire_its_map_and_its_line(tmp_path: Path) -> None:
    assert live.plant_of(parsed(["live"])) is None
    bus = live.plant_of(parsed(["live", "--fresh", "--wire", "can"]))
    assert bus is not None
    assert (bus.wire, bus.serve_arguments(tmp_path), bus.line_file(tmp_path)) == ("can", (), LINE)
    assert bus == PLANTS["CAN by DBC"]
    late = PLANTS["drive 60 ms late"]
    assert "delay_s: 0.06" in late.line_file(tmp_path).read_text()
    with pytest.raises(PlantError, match=r"film\.yaml: this plant is another one, edited"):
        late.line_file(tmp_path, ROOT / "config/lines/film.yaml")
    map_option, file, no_fc23 = replace(
        PLANTS["functions 3 and 16"], plc=PLANTS["low words first"].plc
    ).serve_arguments(tmp_path)
    assert (map_option, no_fc23) == ("--plc", "--no-fc23")
    assert load_plc_map(Path(file)).low_first
