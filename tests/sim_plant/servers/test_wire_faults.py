"""Each fault changes something on each wire that takes it; where it would not, it is refused."""

from __future__ import annotations

import socket
from contextlib import suppress
from dataclasses import replace
from functools import cache

import pytest

from aff_runtime.base.errors import PlantError
from aff_runtime.base.python_can import can
from sim_plant.base.shipped import shipped
from sim_plant.pytest_plugin.can_client import WebLineBus
from sim_plant.servers.control_client import ask as tell
from sim_plant.servers.faults import Fault, parse_fault
from sim_plant.servers.serve import PlantService, ServeOptions
from sim_plant.servers.wire_faults import Medium, WireFaults
from tests.each_case import each_case
from tests.matrix.bench import MatrixBench
from tests.matrix.cells import TABLE
from tests.sim_plant.servers.fake_line import FakeLine, default_map, write_block
from tests.sim_plant.servers.served import Served, served

FOREIGN = {  # what no such wire can do
    Medium.TCP: {"lose", "reorder", "errors", "busoff", "sync", "reset"},
    Medium.UDP: {"reorder", "errors", "busoff", "sync", "reset"},
    Medium.DBC: {"sync", "reset"},
    Medium.CANOPEN: set(),
}
CHOSEN = {Fault.DELAY: "delay=100", Fault.LOSE: "lose=60"}
SILENT_s = 0.05  # loopback needs a hundredth of it
READ = bytes.fromhex("0007 0000 0006 01 03 0000 0012")
READ_BACK = bytes.fromhex("0009 0000 0006 01 03 0064 000A")


def own(medium: Medium) -> list[Fault]:
    return [fault for fault in Fault if fault.value not in FOREIGN[medium]]


def spelt(fault: Fault) -> str:
    return CHOSEN.get(fault, fault.value)


def write(beat: int) -> bytes:
    words = b"".join(word.to_bytes(2, "big") for word in write_block(beat, state=0))
    body = bytes.fromhex("01 10 0064 000A 14") + words
    return bytes.fromhex("0008 0000") + len(body).to_bytes(2, "big") + body


def got(client: socket.socket, request: bytes) -> bytes:
    """All that comes back of one request."""
    data = b""
    with suppress(OSError):
        client.sendall(request)
        while more := client.recv(1024):
            data += more
    return data


def on_modbus(plant: Served, udp: bool, command: str) -> list[bytes]:
    """What a client gets after a command that takes one sample."""
    kind = socket.SOCK_DGRAM if udp else socket.SOCK_STREAM
    control = plant.service._options.control
    with socket.socket(type=kind) as client:
        client.settimeout(SILENT_s)
        client.connect(("127.0.0.1", plant.port))
        heard = [got(client, write(1))]
        assert tell(control, command)["ok"]
        for beat in (2, 3, 4):
            heard += [got(client, request) for request in (write(beat), READ)]
            tell(control, "step 1")
            heard.append(got(client, READ_BACK))
    return heard


@pytest.mark.wire
@pytest.mark.parametrize("udp", [False, True])
@pytest.mark.parametrize("fault", own(Medium.UDP), ids=str)
@pytest.mark.sweep(every=9)
def test_a_fault_of_modbus_changes_what_a_client_gets(tmp_path, fault, udp):
    if fault not in own(Medium.UDP if udp else Medium.TCP):
        return
    seen = []
    for command in ("step 1", f"fault {spelt(fault)}"):
        with served(control=tmp_path / "control", stepped=True, udp=udp) as plant:
            seen.append(on_modbus(plant, udp, command))
    assert seen[0] != seen[1]


@cache
def frames_of(wire: str, fault: Fault | None) -> list[object]:
    """What the runtime hears in 0.2 s of a correction at work."""
    bench = MatrixBench(wire)
    bench.run(0.5)
    bench.arm()
    bench.run(0.5)
    assert any(bench.applied[-5:])
    heard, receive = [], bench.bus.receive

    def listen(wait_ns):
        frame = receive(wait_ns)
        heard.append((bench.plant.scans, frame))
        return frame

    bench.bus.receive = listen
    if fault is not None:
        bench.begin(spelt(fault))
    bench.run(0.2)
    return heard


@pytest.mark.parametrize(
    ("wire", "fault"),
    [
        (wire, fault)
        for wire, medium in (("can", Medium.DBC), ("canopen", Medium.CANOPEN))
        for fault in own(medium)
        if fault is not Fault.ERRORS  # of the adapter: below
    ],
)
@pytest.mark.sweep(every=9)
def test_a_fault_of_a_bus_changes_what_the_runtime_hears(wire, fault):
    assert frames_of(wire, fault) != frames_of(wire, None)


def bus_of(folder, protocol="dbc", **options):
    return served(
        control=folder / "control",
        stepped=True,
        can=protocol,
        can_channel=str(folder / "can"),
        can_map=shipped(f"plc/can_{protocol}.yaml"),
        **options,
    )


@pytest.mark.wire
@pytest.mark.parametrize("protocol", ["dbc", "canopen"])
def test_turns_shows_two_moments_of_every_channel_on_a_bus(tmp_path, protocol):
    """Frames of a scan are those of one of two scans, readings with their words."""
    with bus_of(tmp_path, protocol), WebLineBus(tmp_path / "can") as bus:
        control = tmp_path / "control"

        def scan():
            tell(control, "step 1")
            if protocol == "canopen":
                bus.send(can.Message(arbitration_id=0x080, is_extended_id=False))
                tell(control, "status")
            frames = []
            while (frame := bus.recv(0)) is not None:
                if 0x180 <= frame.arbitration_id < 0x500:
                    frames.append((frame.arbitration_id, bytes(frame.data)))
            return tuple(sorted(frames))

        if protocol == "canopen":
            bus.send(can.Message(arbitration_id=0, data=[1, 0], is_extended_id=False))
        scan(), scan()
        well = [scan() for _ in range(6)]
        tell(control, "fault turns")
        scan(), scan()
        turning = [scan() for _ in range(6)]
    assert well[0]
    assert len(set(well)) == 6
    assert turning[::2] == [turning[0]] * 3
    assert turning[1::2] == [turning[1]] * 3
    assert turning[0] != turning[1]


@pytest.mark.parametrize("medium", list(Medium), ids=str)
def test_what_a_wire_has_not_is_refused_with_the_wires_that_have_it(medium):
    wire = WireFaults(medium=medium)
    for fault in Fault:
        if fault.value not in FOREIGN[medium]:
            wire.check(parse_fault(spelt(fault)), default_map())
            continue
        with pytest.raises(PlantError, match=f"this line is served on {medium.value}$"):
            wire.check(parse_fault(spelt(fault)), default_map())


@each_case("row", TABLE["faults"], ids=lambda row: row["name"])
def test_the_matrix_breaks_a_wire_by_what_it_has_and_leaves_out_what_it_has_not(row):
    if row["spec"].startswith("!"):
        return  # of the runtime
    name = parse_fault(row["spec"]).fault.value
    columns = {"modbus": Medium.TCP, "can": Medium.DBC, "canopen": Medium.CANOPEN}
    for column, medium in columns.items():
        assert (name in FOREIGN[medium]) == (row[column] == "-")


@pytest.mark.wire
@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("fault busoff", "is of CAN by DBC and CANopen; this line is served on Modbus TCP"),
        ("fault nan=unwind_tenson_N", "no such channel; the PLC shows unwind_tension_N, "),
        ("fault nan=true_unwind_tension_N", "no such channel"),
        ("fault stuck=line_speed", "line_speed_m_s"),
        ("fault lose=300", "0 to 100"),
    ],
)
def test_a_fault_that_would_do_nothing_is_refused_by_a_served_line(tmp_path, command, said):
    with served(control=tmp_path / "control", stepped=True):
        assert said in tell(tmp_path / "control", command)["error"]
        assert tell(tmp_path / "control", "status")["faults"] == []


@pytest.mark.wire
def test_a_bus_refuses_the_channel_that_it_does_not_show_and_takes_its_own(tmp_path):
    with bus_of(tmp_path):
        control = tmp_path / "control"
        assert "this line is served on CAN by DBC" in tell(control, "fault sync")["error"]
        assert tell(control, "fault nan=unwind_radius_m")["ok"]


def test_without_a_controller_there_are_no_error_frames():
    wire = WireFaults(medium=Medium.DBC, tells_errors=False)
    with pytest.raises(PlantError, match="frame_socket or slcan_pty"):
        wire.check(parse_fault("errors"), default_map())


def test_a_map_without_a_tension_wants_the_channel_and_one_of_single_words_has_none_to_swap():
    whole = default_map()
    short = tuple(item for item in whole.channels if item.name == "unwind_radius_m")
    wire, plc_map = WireFaults(medium=Medium.TCP), replace(whole, channels=short)
    for spec, said in (("nan", "name a channel"), ("swap", "two words")):
        with pytest.raises(PlantError, match=said):
            wire.check(parse_fault(spec), plc_map)
        wire.check(parse_fault(spec), whole)


def test_a_scheduled_fault_is_checked_before_the_line_is_served():
    options = ServeOptions(faults=(parse_fault("sync@5"),))
    with pytest.raises(PlantError, match="this line is served on Modbus TCP"):
        PlantService(FakeLine(), default_map(), options)


@pytest.mark.wire
def test_a_bus_that_another_took_meanwhile_is_told_until_it_is_free(tmp_path):
    with bus_of(tmp_path):
        control, path = tmp_path / "control", tmp_path / "can"
        tell(control, "fault refuse")
        with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as thief:
            thief.bind(str(path))
            thief.listen()
            assert "another plant listens there" in tell(control, "clear refuse")["error"]
            assert "another plant listens there" in tell(control, "step 1")["error"]
        assert tell(control, "step 1")["ok"]
        with WebLineBus(path) as bus:
            tell(control, "step 1")
            assert bus.recv(1.0) is not None
