import asyncio
import itertools
import json
import socket
import stat
from dataclasses import replace

import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.base.signals import Status
from sim_plant.servers.control import ControlSocket
from sim_plant.servers.control_client import ask as tell
from sim_plant.servers.plant import Plant
from sim_plant.servers.plc import Plc
from sim_plant.servers.serve import PlantService, ServeOptions
from sim_plant.servers.words import RegisterItem
from tests.sim_plant.servers.fake_line import FakeLine, default_map
from tests.sim_plant.servers.served import PATIENCE_s, answered, served


@pytest.fixture
def control():
    plant = Plant(FakeLine(), Plc(default_map()))
    return ControlSocket(None, plant, lambda: {"time_s": plant.time_s}), plant


def test_references_and_status_bits_can_be_set(control):
    socket_, plant = control
    assert answered(socket_, "set line_speed_ref_m_s 0.25") == {"ok": True}
    assert answered(socket_, "set WEB_INTACT 0") == {"ok": True}
    plant.step()
    assert plant.measured["line_speed_m_s"] == 0.25
    assert not plant.plc.status & Status.WEB_INTACT


def test_history_gives_times_and_corrections_oldest_first(control):
    socket_, plant = control
    for _ in range(3):
        plant.step()
    assert answered(socket_, "history 2") == {
        "actuators": ["unwind", "swrap_follower"],
        "time_s": pytest.approx([0.015, 0.020]),
        "applied_m_s": [(0.0, 0.0), (0.0, 0.0)],
    }


def test_faults_are_injected_and_cleared(control):
    socket_, plant = control
    answered(socket_, "fault mute")
    answered(socket_, "fault busy")
    plant.step()
    assert plant.faults.names() == ["mute", "busy"]
    answered(socket_, "clear mute")
    plant.step()
    assert plant.faults.names() == ["busy"]


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("", "unknown command"),
        ("stop", "unknown command"),
        ("set", "set: wrong or missing argument: read nothing; `sim-plant tell --help`"),
        ("set speed 1", "known are line_speed_ref_m_s"),
        ("set WEB_INTACT 2", "bits 0 or 1"),
        ("set tension_ref_N nan", "references are"),
        ("set tension_ref_N ten", "wrong or missing"),
        ("fault", "wrong or missing"),
        ("fault melt", "unknown name"),
        ("clear bsy", "fault 'bsy': unknown name; known are mute, "),
        ("set tension_ref_N -5", "the PLC's word of it holds 0 to 655.35"),
        ("set tension_ref_N 1e6", "the PLC's word of it holds 0 to 655.35"),
        ("history all", "wrong or missing"),
    ],
)
def test_a_wrong_command_is_answered_with_what_is_wrong(control, line, said):
    assert said in answered(control[0], line)["error"]


@pytest.mark.wire
def test_the_socket_answers_lines_of_json_to_its_owner_alone(tmp_path):
    path = tmp_path / "control"
    with served(control=path) as plant:
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        with socket.socket(socket.AF_UNIX) as client:
            client.settimeout(PATIENCE_s)
            client.connect(str(path))
            stream = client.makefile("rw")
            print("status", file=stream, flush=True)
            status = json.loads(stream.readline())
            plant.fault("nan=unwind_tension_N")
            print("status", file=stream, flush=True)
            lying = json.loads(stream.readline())
            print("nonsense", file=stream, flush=True)
            assert "error" in json.loads(stream.readline())
            stream.close()
    assert not path.exists()
    assert status["counts"]["foreign_writes"] == 0
    assert status["true_tension_N"].keys() == {"true_unwind_tension_N"}
    assert status["applied_m_s"] == {"unwind": 0.0, "swrap_follower": 0.0}
    assert lying["measured"]["unwind_tension_N"] is None
    assert lying["true_tension_N"]["true_unwind_tension_N"] > 0.0


@pytest.mark.wire
def test_a_socket_left_behind_is_replaced_and_a_file_is_not(tmp_path, control):
    path = tmp_path / "control"

    async def open_and_close():
        opened = ControlSocket(path, control[1], dict)
        await opened.open()
        await opened.close()

    with socket.socket(socket.AF_UNIX) as old:
        old.bind(str(path))
    asyncio.run(open_and_close())
    assert not path.exists()
    path.write_text("precious", encoding="ascii")
    with pytest.raises(PlantError, match="cannot open control socket"):
        asyncio.run(open_and_close())
    assert path.read_text(encoding="ascii") == "precious"


@pytest.mark.wire
@pytest.mark.parametrize("kind", [socket.SOCK_STREAM, socket.SOCK_SEQPACKET])
def test_a_path_where_another_listens_is_refused_and_the_other_goes_on(tmp_path, control, kind):
    path = tmp_path / "control"
    with socket.socket(socket.AF_UNIX, kind) as other:
        other.bind(str(path))
        other.listen()
        with pytest.raises(PlantError, match="another plant listens there"):
            asyncio.run(ControlSocket(path, control[1], dict).open())
        with socket.socket(socket.AF_UNIX, kind) as client:
            client.connect(str(path))


@pytest.mark.wire
def test_two_plants_with_one_path_leave_the_first_reachable(tmp_path):
    path = tmp_path / "control"
    with served(control=path, stepped=True) as first:
        second = PlantService(
            FakeLine(), default_map(), ServeOptions(port=0, control=path, stepped=True)
        )
        with pytest.raises(PlantError, match="another plant listens there"):
            asyncio.run(second.run(lambda _: None))
        assert tell(path, "step 1")["time_s"] == pytest.approx(first.service.plant.time_s)
    assert not path.exists()


@pytest.mark.wire
def test_a_socket_that_came_into_its_place_is_not_taken_away_with_it(tmp_path, control):
    path = tmp_path / "control"

    async def replaced_and_closed():
        opened = ControlSocket(path, control[1], dict)
        await opened.open()
        path.rename(tmp_path / "old")
        with socket.socket(socket.AF_UNIX) as other:
            other.bind(str(path))
            await opened.close()

    asyncio.run(replaced_and_closed())
    assert path.is_socket()


def test_the_supplier_of_a_roll_is_drawn_with_it_and_can_be_told():
    class Changing(FakeLine):
        def change_rolls(self):
            pass

    word = RegisterItem(name="unwind_supplier_number", address=40, type="u16")
    given = default_map()
    shown = replace(given, channels=(*given.channels, word), read_count=41 - given.read_start)
    plant = Plant(Changing(), Plc(shown))
    socket_, seen = ControlSocket(None, plant, dict), []
    for _ in range(6):
        answered(socket_, "roll")
        for _ in range(500):
            plant.step()
        seen.append(plant.shown.words[40 - given.read_start])
    assert len(set(seen)) > 1
    assert set(seen) <= {1, 2, 3, 4}
    assert answered(socket_, "set unwind_supplier_number 4711") == {"ok": True}
    plant.step()
    assert plant.shown.words[40 - given.read_start] == 4711
    assert "65535" in answered(socket_, "set unwind_supplier_number 70000")["error"]


@pytest.mark.parametrize("name", ["unwind_supplier_number", "unwind_torque_N_m"])
def test_a_wire_of_its_own_may_ask_for_words_that_the_map_has_not(name):
    class Driven(FakeLine):
        def torque_N_m(self, roller):
            assert roller == "unwind"
            return float(plant.extra.supplier)  # any number

    plant = Plant(Driven(), Plc(default_map()))
    assert name not in plant.shown.measured
    plant.ask_for({name})
    assert plant.shown.measured[name] == plant.extra.supplier
    plant.extra.supplier = 7
    plant.step()
    assert plant.measured[name] == plant.shown.measured[name] == 7.0


def test_a_roll_is_changed_in_the_middle_of_an_announced_splice():
    class Changing(FakeLine):
        changes = 0

        def change_rolls(self):
            assert plant.plc.status & Status.SPLICE_ACTIVE
            self.changes += 1

    line = Changing()
    plant = Plant(line, Plc(default_map()))
    answer = answered(ControlSocket(None, plant, dict), "roll")
    assert answer == {"ok": True, "change_s": pytest.approx(plant.time_s + 1.0)}
    while plant.time_s < answer["change_s"] - 1e-9:
        assert line.changes == 0
        plant.step()
    for _ in range(300):
        plant.step()
    assert line.changes == 1
    assert plant.plc.roll_id == 2
    assert not plant.plc.status & Status.SPLICE_ACTIVE


def test_after_clear_the_status_word_is_what_it_was_before_two_faults_of_one_sample(control):
    socket_, plant = control
    before = plant.plc.status
    for bit in ("WEB_INTACT", "ESTOP_OK"):
        answered(socket_, f"fault permissive={bit}")
    plant.step()
    assert plant.plc.status == before & ~Status.ESTOP_OK & ~Status.WEB_INTACT
    answered(socket_, "clear")
    plant.step()
    assert plant.plc.status == before


class Rolls(FakeLine):
    """Counts exchanges."""

    changes = 0

    def change_rolls(self):
        self.changes += 1


@pytest.mark.parametrize("clear_after", [0, 1, 50, 190])
@pytest.mark.parametrize("command", ["clear", "clear splice", "fault splice:0.01"])
@pytest.mark.sweep(every=5)
def test_rolls_whose_splice_is_over_before_they_are_on_never_come(clear_after, command):
    plant = Plant(Rolls(), Plc(default_map()))
    socket_ = ControlSocket(None, plant, dict)
    answered(socket_, "roll")
    for _ in range(clear_after):
        plant.step()
    assert answered(socket_, command)["ok"]
    for _ in range(500):
        plant.step()
    assert plant._line.changes == 0
    assert not plant.plc.status & Status.SPLICE_ACTIVE
    assert answered(socket_, "roll")["ok"]  # and it can be asked for again
    for _ in range(500):
        plant.step()
    assert plant._line.changes == 1


def test_rolls_that_are_coming_are_not_asked_for_twice_and_later_ones_are_counted():
    plant = Plant(Rolls(), Plc(default_map()))
    socket_ = ControlSocket(None, plant, dict)
    seen = []
    for second in range(6):
        answer = answered(socket_, "roll")
        assert ("already" in answer.get("error", "")) == bool(second % 2)
        for _ in range(120):  # 0.6 s
            plant.step()
            announced = bool(plant.plc.status & Status.SPLICE_ACTIVE)
            seen.append((plant._line.changes, plant.plc.roll_id, announced))
    jumps = [b for a, b in itertools.pairwise(seen) if a[0] != b[0]]
    assert jumps == [(1, 2, True), (2, 3, True), (3, 4, True)][: len(jumps)]
    assert len(jumps) >= 2


def test_a_line_without_rolls_says_so(control):
    assert "no rolls" in answered(control[0], "roll")["error"]


def test_a_line_without_the_channels_of_the_map_says_what_to_give():
    class Bare(FakeLine):
        def step(self, inputs):
            return {"line_speed_m_s": 1.0, "true_unwind_tension_N": 90.0}

    with pytest.raises(PlantError) as refused:
        Plant(Bare(), Plc(default_map()))
    assert "the line measures ['line_speed_m_s']; give a map of its own channels: " in str(
        refused.value
    )
    assert "`--plc MAP.yaml`, in a test `plc=`" in str(refused.value)
