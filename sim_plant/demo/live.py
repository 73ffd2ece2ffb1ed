"""Plant, service, commissioner and screen on loopback until somebody ends them."""

from __future__ import annotations

import secrets
import subprocess
from contextlib import ExitStack
from dataclasses import replace
from itertools import pairwise
from pathlib import Path

from aff_runtime.base.errors import PlantError
from sim_plant.demo.processes import RUNTIME, SCREEN, Bench, Child
from sim_plant.demo.session import (
    DemoPlan,
    Progress,
    arm,
    await_state,
    pause,
    plant_command,
    prepare,
    probe,
    service_command,
)
from sim_plant.demo.unusual_plants import PLC_MAP, UnusualPlant
from sim_plant.demo.wires import MODBUS
from sim_plant.servers.map_file import load_plc_map

LOOK_S = 0.5
FILES = {"can": "*.dbc", "canopen": "*.eds"}
ACCOUNT = "demo"


def run_live(
    plan: DemoPlan,
    progress: Progress,
    *,
    listen: str,
    hands_off: bool,
    fresh: UnusualPlant | None = None,
) -> None:
    """Run until interrupted, or until one of them ends.

    Parameters
    ----------
    listen : ``ADDRESS:PORT`` of the screen.
    hands_off : leave probing and arming to whoever looks.
    fresh : plant to commission: there is no site file, that too is left to whoever looks.

    Raises
    ------
    PlantError
        When one of them does not start, or ends.
    """
    bench, line = prepare(plan), plan.line
    if fresh is not None:
        bench.site.unlink()
        more = fresh.serve_arguments(bench.folder)
        bench = replace(bench, plant_arguments=(*bench.plant_arguments, *more))
        line = fresh.line_file(bench.folder, line)
    with ExitStack() as stack:
        progress("starting the plant (compiles its kernel the first time)")
        command = plant_command(bench, line, plan.line_speed_m_s, plan.seed)
        plant = Child("plant", command, bench.folder / "plant.log", "ready")
        stack.enter_context(plant)
        command = [*service_command(bench), "--hand", "commission", "--wait"]
        command += ["--state-dir", str(bench.folder / "state")]
        service = Child("runtime", command, bench.folder / "runtime.log")
        stack.enter_context(service)
        accounts = bench.folder / "accounts"
        password = _account(accounts)
        commissioner = _commissioner(bench, accounts, plan.line)
        stack.enter_context(commissioner)
        screen = _screen(bench, listen, accounts)
        stack.enter_context(screen)
        url = screen.await_line("look: ", 30.0).removeprefix("look: ")
        progress(f"\n  look at the line: {url}")
        progress(f"  bypass, arm, commission: log in as {ACCOUNT}, password {password}\n")
        if fresh is not None:
            progress(f"  the PLC to commission: {_reached(bench, fresh)}\n")
        else:
            await_state(bench, service, {"FAULT", "OFF", "READY"}, 30.0)
            if not hands_off:
                _operate(bench, progress)
        progress(_commands(bench))
        children = (plant, service, commissioner, screen)
        while all(child.process.poll() is None for child in children):
            pause(LOOK_S)
        ended = next(child for child in children if child.process.poll() is not None)
        raise PlantError(f"the {ended.name} ended: {ended.tail()}")


def _reached(bench: Bench, plant: UnusualPlant) -> str:
    """Return how the PLC is reached, and where its manual is."""
    given = dict(pairwise(bench.plant_arguments))
    if plant.wire != MODBUS:
        files = sorted(bench.folder.glob(FILES[plant.wire]))
        names = ", ".join(one.name for one in files)
        return (
            f"interface frame_socket, channel {given['--channel']}; beside the site file: {names}"
        )
    manual = Path(given.get("--plc", PLC_MAP))  # the shipped one, where it is not edited
    words = load_plc_map(manual)
    return (
        f"{given['--modbus']}, {words.read_count} words from wire address {words.read_start}; "
        f"its manual: {manual}"
    )


def _account(accounts: Path) -> str:
    """Make an account for this line alone; return its password."""
    password = secrets.token_hex(6)
    command = [*SCREEN, "account", "add", ACCOUNT, "--role", "commission", "--accounts"]
    made = subprocess.run(
        [*command, str(accounts)],
        input=f"{password}\n",
        capture_output=True,
        text=True,
        check=False,
    )
    if made.returncode != 0:
        raise PlantError(f"the screen's account: {made.stderr.strip()}")
    return password


def _screen(bench: Bench, listen: str, accounts: Path) -> Child:
    """Start the screen; its address is its first line."""
    run = bench.runtime_dir
    command = [*SCREEN, "--door", str(run / "door.sock"), "--listen", listen]
    command += ["--hand-socket", str(run / "hand.sock"), "--accounts", str(accounts)]
    command += ["--commission-socket", str(run / "commission.sock")]
    command += ["--state", str(bench.folder / "screen")]
    return Child("screen", command, bench.folder / "screen.log", piped=True)


def _commissioner(bench: Bench, accounts: Path, line: Path) -> Child:
    """Start what lets the screen commission."""
    command = [*RUNTIME, "commission", str(bench.site), "--card", str(bench.folder / "card")]
    command += ["--accounts", str(accounts), "--runtime-dir", str(bench.runtime_dir)]
    command += ["--state-dir", str(bench.folder / "state")]
    command += ["--record-dir", str(bench.folder / "runs"), "--line", str(line)]
    return Child("commissioner", command, bench.folder / "commissioner.log", "ready")


def _operate(bench: Bench, progress: Progress) -> None:
    """Probe and arm, as the operator of a demo; a refusal is told and left to who looks."""
    pause(12.0)  # the screen wants ten seconds for the ripple without AFF
    progress("probing the response of both actuators (a small excitation, line running)")
    try:
        probe(bench, progress)
        arm(bench, progress)
        progress("armed: the ripple goes")
    except PlantError as error:
        progress(str(error))


def _commands(bench: Bench) -> str:
    """Return what can be tried beside the screen."""
    of = f"--runtime-dir {bench.runtime_dir}"
    return (
        f"in another terminal: aff-runtime bypass {of}\n"
        f"                     aff-runtime arm {of}\n"
        f"the roll lasts some minutes; another one: sim-plant tell {bench.plant_socket} roll\n"
        "ctrl-c ends them all"
    )
