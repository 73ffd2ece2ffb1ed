"""Golden bytes: function code and data as MODBUS Application Protocol V1.1b3 lays them out."""

from sim_plant.servers.modbus_device import ModbusDevice
from sim_plant.servers.registers import Registers
from tests.each_case import each_case
from tests.sim_plant.servers.fake_line import default_map


def device(**options):
    registers = Registers(default_map())
    registers.publish([0x0007, 0x006F, 0x0001, 0x5C70, *range(4, 15)])
    return ModbusDevice(registers, **options), registers


@each_case(
    ("request_", "answer"),
    [
        # FC3: address 0, 4 words -> byte count 8, words high byte first
        ("03 0000 0004", "03 08 0007 006F 0001 5C70"),
        # FC6: echo of address and value
        ("06 0064 1234", "06 0064 1234"),
        # FC16: address 103, 2 words, 4 bytes -> address and count
        ("10 0067 0002 04 04D2 FB2D", "10 0067 0002"),
        # FC23: read 2 at 0, write 1 at 100 -> byte count 4
        ("17 0000 0002 0064 0001 02 ABCD", "17 04 0007 006F"),
        # FC23 reads what it has just written
        ("17 0064 0001 0064 0001 02 ABCD", "17 02 ABCD"),
    ],
)
def test_requests_are_answered_as_the_specification_says(request_, answer):
    assert device()[0].answer(bytes.fromhex(request_)) == bytes.fromhex(answer)


@each_case(
    ("request_", "answer"),
    [
        ("01 0000 0001", "81 01"),  # FC1 is not served
        ("04 0000 0001", "84 01"),
        ("2B 0E 01 00", "AB 01"),
        ("99", "99 01"),  # already an exception code
        ("03 000E 0002", "83 02"),  # last word and one behind it
        ("03 0032 0001", "83 02"),  # between the blocks
        ("06 0000 0001", "86 02"),  # the PLC's own block
        ("10 006D 0002 04 0000 0000", "90 02"),  # one word behind the write block
        ("17 0000 0001 0000 0001 02 0000", "97 02"),
        ("17 0032 0001 0064 0001 02 0000", "97 02"),
        ("03 0000 0000", "83 03"),  # no words
        ("03 0000 007E", "83 03"),  # 126 words
        ("03 0000 00", "83 03"),  # cut off
        ("10 0064 0000 00", "90 03"),
        ("10 0064 0002 02 0000", "90 03"),  # byte count against count
        ("10 0064 0002 04 0000", "90 03"),  # bytes missing
        ("17 0000 0000 0064 0001 02 0000", "97 03"),
        ("17 0000 0001 0064 0000 00", "97 03"),
    ],
)
def test_wrong_requests_get_the_exception_of_the_specification(request_, answer):
    tested, registers = device()
    assert tested.answer(bytes.fromhex(request_)) == bytes.fromhex(answer)
    assert registers.write_words == [0] * 10
    assert tested.exceptions == 1


def test_a_device_without_fc23_says_so_and_still_takes_fc16():
    tested, registers = device(allow_fc23=False)
    assert tested.answer(bytes.fromhex("17 0000 0002 0064 0001 02 ABCD")) == b"\x97\x01"
    assert registers.write_words[0] == 0
    assert tested.answer(bytes.fromhex("10 0064 0001 02 ABCD")) == bytes.fromhex("10 0064 0001")


def test_a_busy_device_obeys_nothing():
    tested, registers = device()
    assert tested.answer(bytes.fromhex("06 0064 1234"), busy=True) == b"\x86\x06"
    assert registers.write_words[0] == 0
