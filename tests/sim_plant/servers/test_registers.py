from sim_plant.servers.registers import Registers
from tests.sim_plant.servers.fake_line import default_map


def test_only_the_write_block_can_be_written_and_the_rest_is_counted():
    registers = Registers(default_map())
    registers.publish(range(15))
    assert registers.write(100, list(range(10)))
    for address, count in [(99, 1), (0, 1), (14, 1), (109, 2), (110, 1), (65535, 1), (100, 11)]:
        assert not registers.write(address, [7] * count)
    assert registers.write_words == list(range(10))
    assert registers.read_words == list(range(15))
    assert (registers.writes, registers.foreign_writes) == (1, 7)


def test_both_blocks_can_be_read_and_nothing_between_them():
    registers = Registers(default_map())
    registers.publish(range(15))
    registers.write(103, [11, 12])
    assert registers.read(2, 2) == [2, 3]
    assert registers.read(102, 4) == [0, 11, 12, 0]
    assert registers.read(14, 2) is None
    assert registers.read(50, 1) is None
    assert (registers.reads, registers.foreign_reads) == (2, 2)
