"""Golden frames and wire faults over a real socket."""

import pytest
from pymodbus.client import ModbusTcpClient

from tests.sim_plant.servers.served import ask, closed, receive, served, silent, wait_until

pytestmark = pytest.mark.wire

READ_ROLL_ID = "1234 0000 0006 11 03 0008 0001"
ROLL_ID_IS_1 = bytes.fromhex("1234 0000 0005 11 03 02 0001")


@pytest.fixture(scope="module")
def plant():
    with served(idle_timeout_s=30.0) as running:
        yield running


@pytest.fixture
def client(plant):
    with plant.client() as connected:
        yield connected
    plant.command("clear")
    wait_until(lambda: not plant.command("status")["faults"])
    wait_until(lambda: plant.service.server.connections == 0)


@pytest.mark.parametrize(
    ("request_", "answer"),
    [
        (READ_ROLL_ID, ROLL_ID_IS_1.hex()),
        ("0001 0000 0006 01 06 0065 0001", "0001 0000 0006 01 06 0065 0001"),
        ("0002 0000 000B 01 10 0064 0002 04 0007 0001", "0002 0000 0006 01 10 0064 0002"),
        ("0003 0000 000D 01 17 0008 0001 0064 0001 02 0009", "0003 0000 0005 01 17 02 0001"),
        ("FFFF 0000 0006 00 03 0032 0001", "FFFF 0000 0003 00 83 02"),
        ("0004 0000 0002 01 07", "0004 0000 0003 01 87 01"),
    ],
)
def test_frames_are_answered_byte_for_byte(client, request_, answer):
    expected = bytes.fromhex(answer)
    assert ask(client, request_, len(expected)) == expected


def test_several_frames_in_one_segment_and_one_frame_in_many_are_all_answered(client):
    frame = bytes.fromhex(READ_ROLL_ID)
    client.sendall(3 * frame)
    assert receive(client, 3 * len(ROLL_ID_IS_1)) == 3 * ROLL_ID_IS_1
    for byte in frame:
        client.sendall(bytes([byte]))
    assert receive(client, len(ROLL_ID_IS_1)) == ROLL_ID_IS_1


@pytest.mark.parametrize(
    "garbage",
    ["0001 0001 0006 01 03 0000 0001", "0001 0000 0000 01", "0001 0000 00FF 01", 40 * "FF"],
)
def test_a_stream_that_is_no_modbus_is_cut_off(client, garbage):
    client.sendall(bytes.fromhex(garbage))
    assert closed(client)


def test_pymodbus_own_client_reads_and_writes_everything(plant, client):
    del client
    peer = ModbusTcpClient("127.0.0.1", port=plant.port, timeout=5)
    try:
        assert peer.connect()
        assert peer.write_registers(100, [1, 2, 3]).registers == []
        block = peer.readwrite_registers(
            read_address=0, read_count=15, write_address=103, values=[4, 0xFFFB]
        )
        tension_N = peer.convert_from_registers(block.registers[2:4], peer.DATATYPE.INT32) * 0.001
        assert 80.0 < tension_N < 100.0
        assert block.registers[4] == 9000
        assert peer.write_register(109, 77).registers == [77]
        written = peer.read_holding_registers(100, count=10).registers
        assert written == [1, 2, 3, 4, 0xFFFB, 0, 0, 0, 0, 77]
        foreign = plant.command("status")["counts"]["foreign_writes"]
        assert peer.write_registers(0, [1]).exception_code == 2
        assert plant.command("status")["counts"]["foreign_writes"] == foreign + 1
        assert peer.read_coils(0).exception_code == 1
    finally:
        peer.close()


def test_the_heartbeat_moves_in_real_time(client):
    def heartbeat():
        return ask(client, "0001 0000 0006 01 03 0000 0001", 11)[-2:]

    first = heartbeat()
    wait_until(lambda: heartbeat() != first)


def test_a_fifth_connection_is_turned_away(plant, client):
    more = [plant.client() for _ in range(3)]
    fifth = plant.client()
    try:
        assert closed(fifth)
        assert all(ask(one, READ_ROLL_ID, 11) == ROLL_ID_IS_1 for one in [client, *more])
    finally:
        for one in [*more, fifth]:
            one.close()


def test_a_mute_plc_neither_answers_nor_obeys(plant, client):
    ask(client, "0001 0000 0006 01 06 006B 0005", 12)
    plant.fault("mute")
    client.sendall(bytes.fromhex("0001 0000 0006 01 06 006B 0006"))
    assert silent(client)
    assert plant.service.plant.registers.write_words[7] == 5


def test_a_frozen_plc_answers_with_a_still_heartbeat(plant, client):
    plant.fault("freeze")
    first = ask(client, "0001 0000 0006 01 03 0000 000F", 39)
    scans = plant.service.plant.scans
    wait_until(lambda: plant.service.plant.scans > scans + 5)
    assert ask(client, "0001 0000 0006 01 03 0000 000F", 39) == first


@pytest.mark.parametrize(
    ("fault", "answer"),
    [
        ("busy", "1234 0000 0003 11 83 06"),
        ("tid", "1235 0000 0005 11 03 02 0001"),
        ("short", "1234 0000 0003 11 03 00"),
        ("delay=30", ROLL_ID_IS_1.hex()),
    ],
)
def test_lying_answers(plant, client, fault, answer):
    plant.fault(fault)
    expected = bytes.fromhex(answer)
    assert ask(client, READ_ROLL_ID, len(expected)) == expected
    assert silent(client, 0.05)


def test_a_partial_answer_stops_half_way(plant, client):
    plant.fault("partial")
    assert ask(client, READ_ROLL_ID, 5) == ROLL_ID_IS_1[:5]
    assert silent(client)


def test_a_short_write_answer_has_a_length_that_agrees(plant, client):
    plant.fault("short")
    assert ask(client, "0001 0000 0006 01 06 0065 0001", 10) == bytes.fromhex(
        "0001 0000 0004 01 06 0065"
    )


def test_drop_ends_the_connection_and_lets_a_new_one_in(plant, client):
    plant.command("fault drop")
    assert closed(client)
    wait_until(lambda: not plant.command("status")["faults"])
    with plant.client() as again:
        assert ask(again, READ_ROLL_ID, 11) == ROLL_ID_IS_1


def test_lasting_drop_ends_every_connection_at_its_first_request(plant, client):
    plant.fault("drop:60")
    with plant.client() as again:
        again.sendall(bytes.fromhex(READ_ROLL_ID))
        assert closed(again)


@pytest.mark.parametrize("fault", ["refuse:60", "restart:60"])
def test_an_absent_plc_refuses_connections_until_it_is_back(plant, client, fault):
    assert ask(client, READ_ROLL_ID, 11) == ROLL_ID_IS_1  # taken in, not only in the queue
    plant.fault(fault)
    assert closed(client)
    with pytest.raises(ConnectionRefusedError):
        plant.client()
    plant.command("clear")

    def answers():
        try:
            with plant.client() as again:
                return ask(again, READ_ROLL_ID, 11) == ROLL_ID_IS_1
        except ConnectionError:
            return False

    wait_until(answers)


def test_a_silent_client_is_cut_off():
    with served(idle_timeout_s=0.05) as plant, plant.client() as client:
        assert closed(client)


def test_a_device_without_fc23_refuses_it():
    with served(allow_fc23=False) as plant, plant.client() as client:
        request = "0003 0000 000D 01 17 0008 0001 0064 0001 02 0009"
        assert ask(client, request, 9) == bytes.fromhex("0003 0000 0003 01 97 01")
