"""Real sockets, virtual time: what a client gets is decided by commands alone."""

import asyncio
import socket
from dataclasses import replace
from itertools import pairwise

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.servers.control_client import ask as tell
from sim_plant.servers.stepped import MOST_SAMPLES, SteppedClock
from tests.sim_plant.servers.fake_line import default_map
from tests.sim_plant.servers.served import (
    PATIENCE_s,
    SAMPLE_TIME_s,
    ask,
    closed,
    receive,
    served,
    silent,
    wait_until,
)

pytestmark = pytest.mark.wire

READ = "0007 0000 0006 01 03 0000 0010"  # the whole read block, FC3
ANSWER_BYTES = 9 + 2 * 16
NAN = "80000000"
NAN_SWAPPED = "00008000"  # the lowest i32, its low word first


@pytest.fixture
def control(tmp_path):
    return tmp_path / "control"


def test_time_passes_by_the_samples_asked_for_and_by_nothing_else(control):
    with served(control=control, stepped=True) as plant, plant.client() as client:
        before = tell(control, "status")["time_s"]
        heartbeats = [ask(client, READ, ANSWER_BYTES)[9:11] for _ in range(3)]
        assert len(set(heartbeats)) == 1
        assert tell(control, "step 250") == {
            "ok": True,
            "time_s": pytest.approx(before + 250 * SAMPLE_TIME_s),
        }
        moved = ask(client, READ, ANSWER_BYTES)[9:11]
        assert int.from_bytes(moved, "big") - int.from_bytes(heartbeats[0], "big") == 250
        assert tell(control, "status")["realtime"] == "stepped"


SCENE = (
    "step 7",
    "fault swap",
    "fault nan=unwind_tension_N@0.04:0.02",
    "step 4",
    "step 1",
    "clear",
)
SAMPLES = (7, 1, 0, 4, 1, 1)  # that each takes


def _bytes_of_a_scene(control):
    got = b""
    with served(control=control, stepped=True) as plant, plant.client() as client:
        for command in SCENE:
            assert tell(control, command)["ok"]
            got += ask(client, READ, ANSWER_BYTES)
    return got


def test_two_runs_give_the_same_bytes_on_the_wire(control):
    first = _bytes_of_a_scene(control)
    parts = [first[at : at + ANSWER_BYTES] for at in range(0, len(first), ANSWER_BYTES)]
    heartbeats = [int.from_bytes(part[9:11], "big") for part in parts]
    assert tuple(after - before for before, after in pairwise(heartbeats)) == SAMPLES[1:]
    tensions = [part[13:17].hex() for part in parts]
    assert [tension == NAN_SWAPPED for tension in tensions] == [False] * 3 + [True] * 2 + [False]
    assert _bytes_of_a_scene(control) == first


@pytest.mark.parametrize("stepped", [True, False])
def test_a_fault_is_in_force_when_it_is_answered_and_over_when_its_end_is(control, stepped):
    with served(control=control, stepped=stepped) as plant, plant.client() as client:
        for _ in range(10):
            tell(control, "fault busy")
            assert ask(client, READ, 9)[7:9] == bytes([0x83, 6])
            tell(control, "clear busy")
            assert ask(client, READ, ANSWER_BYTES)[7] == 3


def heartbeat(client):
    return int.from_bytes(ask(client, READ, ANSWER_BYTES)[9:11], "big")


@pytest.mark.parametrize("stepped", [True, False])
def test_a_plc_that_scans_slowly_has_scanned_when_a_command_is_answered(control, stepped):
    """A scan of five samples: what the words say of a fault is there, and gone, on the answer."""
    slow = replace(default_map(), scan_s=5 * SAMPLE_TIME_s)
    with served(control=control, stepped=stepped, plc=slow) as plant, plant.client() as client:
        for _ in range(3):
            before = heartbeat(client)
            tell(control, "fault nan=unwind_tension_N")
            lying = ask(client, READ, ANSWER_BYTES)
            tell(control, "clear")
            assert lying[13:17].hex() == NAN
            assert ask(client, READ, ANSWER_BYTES)[13:17].hex() != NAN
            assert heartbeat(client) - before == 2 or not stepped
            tell(control, "set tension_ref_N 75")
            assert ask(client, READ, ANSWER_BYTES)[17:19] == (7500).to_bytes(2, "big")
            tell(control, "set tension_ref_N 90")


@pytest.mark.parametrize("fault", ["refuse", "restart"])
def test_a_port_that_another_took_meanwhile_is_told_until_it_is_free(control, fault):
    with served(control=control, stepped=True) as plant:
        tell(control, f"fault {fault}")
        with socket.socket() as thief:
            thief.bind(("127.0.0.1", plant.port))
            thief.listen()
            wrong = f"cannot listen on 127.0.0.1:{plant.port}"
            assert wrong in tell(control, f"clear {fault}")["error"]
            assert wrong in tell(control, "step 1")["error"]
        wait_until(lambda: "ok" in tell(control, "step 1"))
        with plant.client() as client:
            assert ask(client, READ, ANSWER_BYTES)[7] == 3


def test_a_fault_that_begins_later_is_answered_at_once_and_takes_no_sample(control):
    with served(control=control, stepped=True):
        now_s = tell(control, "status")["time_s"]
        assert tell(control, "fault mute@5") == {
            "ok": True,
            "start_s": pytest.approx(now_s + 5.0),
            "time_s": now_s,
        }


def test_a_late_answer_is_late_by_plant_time(control):
    with served(control=control, stepped=True) as plant, plant.client() as client:
        tell(control, "fault delay=25")
        client.sendall(bytes.fromhex(READ))
        tell(control, f"step {round(0.02 / SAMPLE_TIME_s)}")
        assert silent(client)
        tell(control, "step 1")
        client.settimeout(PATIENCE_s)
        assert len(client.recv(ANSWER_BYTES)) == ANSWER_BYTES


def test_what_was_sent_before_a_step_is_obeyed_before_its_first_sample(control):
    with (
        served(control=control, stepped=True) as plant,
        socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as commands,
    ):
        commands.settimeout(PATIENCE_s)
        commands.connect(str(control))
        commands.sendall(b"status\n")  # taken: the step need not wait for the connection
        with commands.makefile("rb") as answers:
            assert answers.readline()
            with plant.client() as client:
                client.sendall(bytes.fromhex(READ))
                commands.sendall(b"step 1\n")
                answers.readline()
                early = receive(client, ANSWER_BYTES)
                late = ask(client, READ, ANSWER_BYTES)
    assert int.from_bytes(late[9:11], "big") - int.from_bytes(early[9:11], "big") == 1


def test_a_restarted_plc_hangs_up_and_listens_again_when_the_step_is_answered(control):
    with served(control=control, stepped=True) as plant, plant.client() as client:
        tell(control, "fault restart")
        assert closed(client)
        with pytest.raises(ConnectionRefusedError):
            plant.client()
        tell(control, f"step {round(1.0 / SAMPLE_TIME_s) + 1}")
        with plant.client() as again:
            assert ask(again, READ, ANSWER_BYTES)[7] == 3


def test_a_silent_client_is_cut_off_by_plant_time(control):
    with (
        served(control=control, stepped=True, idle_timeout_s=1.0) as plant,
        plant.client() as client,
    ):
        ask(client, READ, ANSWER_BYTES)
        tell(control, f"step {round(2.0 / SAMPLE_TIME_s) + 1}")
        assert closed(client)


def test_a_value_is_the_lines_own_whatever_the_wire_says(control):
    with served(control=control, stepped=True):
        tell(control, "fault nan=unwind_tension_N")
        assert tell(control, "value unwind_tension_N")["value"] is None
        assert tell(control, "value true_unwind_tension_N")["value"] == pytest.approx(90.0, abs=6)
        assert "there are" in tell(control, "value speed")["error"]


@pytest.mark.parametrize(
    ("command", "said"),
    [("step 0", "1 to"), (f"step {MOST_SAMPLES + 1}", "1 to"), ("step some", "whole number")],
)
def test_a_step_of_nonsense_is_refused(control, command, said):
    with served(control=control, stepped=True):
        assert said in tell(control, command)["error"]


def test_a_plant_in_real_time_is_not_stepped(control):
    with served(control=control):
        assert "serve --stepped" in tell(control, "step 1")["error"]


def test_a_line_that_fails_is_told_to_who_stepped_and_to_the_service():
    def fail():
        raise ArithmeticError("kernel")

    async def settled():
        pass

    async def run():
        clock = SteppedClock(fail, settled)
        failure = clock.start()
        with pytest.raises(PlantError, match="the line failed"):
            await clock.advance(3)
        await asyncio.wait_for(failure, 1.0)

    with pytest.raises(ArithmeticError, match="kernel"):
        asyncio.run(run())
