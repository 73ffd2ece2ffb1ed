from __future__ import annotations

from pathlib import Path

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.base.signals import Outcome
from aff_runtime.config.can_wire import network_of, wire_files
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.canopen.device_402 import object_of
from aff_runtime.fieldbus.canopen.eds_file import load_eds
from aff_runtime.fieldbus.canopen.node import NodeKeeper, NodePlan, NodeState, SdoWrite
from tests.aff_runtime.fieldbus.canopen_bench import SITE, CanopenBench
from tests.each_case import each_case

CONFIG = Path(__file__).parents[4] / "config"
MS = 1_000_000
FILES = wire_files(SITE, CONFIG)
WRITES = (
    SdoWrite(index=0x1017, subindex=0, data=b"\x32\x00"),
    SdoWrite(index=0x1800, subindex=1, data=b"\x83\x01\x00\x80", verify=False),
    SdoWrite(index=0x1800, subindex=2, data=b"\x01"),
)


def hexed(frame: Frame | None) -> str:
    assert frame is not None
    return f"{frame.can_id:03X} {frame.data.hex(' ').upper()}"


def said(text: str) -> Frame:
    can_id, _, data = text.partition(" ")
    return Frame(int(can_id, 16), False, bytes.fromhex(data))


def keeper() -> NodeKeeper:
    return NodeKeeper(NodePlan(name="drive", node_id=3, writes=WRITES, heartbeat_ms=50), 0)


# requests and answers byte by byte as CiA 301 writes them: expedited download of 2, 4, 1 bytes
# (0x2B, 0x23, 0x2F), answer 0x60; upload 0x40, answers 0x4B (2 bytes) and 0x4F (1 byte)
DIALOGUE = (
    ("000 80 03", None),
    ("603 2B 17 10 00 32 00 00 00", "583 60 17 10 00 00 00 00 00"),
    ("603 23 00 18 01 83 01 00 80", "583 60 00 18 01 00 00 00 00"),
    ("603 2F 00 18 02 01 00 00 00", "583 60 00 18 02 00 00 00 00"),
    ("603 40 17 10 00 00 00 00 00", "583 4B 17 10 00 32 00 00 00"),
    ("603 40 00 18 02 00 00 00 00", "583 4F 00 18 02 01 00 00 00"),
    ("603 40 01 10 00 00 00 00 00", "583 4F 01 10 00 00 00 00 00"),  # 0x1001: no error
    ("000 01 03", "703 05"),
)


def start(node: NodeKeeper, register: str = "00", now_ns: int = 0) -> None:
    for request, answer in DIALOGUE:
        assert hexed(node.tick(now_ns)) == request
        if answer is not None:
            shown = answer.replace("4F 01 10 00 00", f"4F 01 10 00 {register}")
            assert node.take(said(shown), now_ns)


def started() -> NodeKeeper:
    node = keeper()
    start(node)
    assert node.good
    return node


def test_a_node_is_configured_read_back_and_started_in_the_bytes_of_the_standard() -> None:
    assert started().state is NodeState.OPERATIONAL


def test_a_node_that_reads_back_something_else_is_never_started() -> None:
    node = keeper()
    for request, answer in DIALOGUE[:5]:
        assert hexed(node.tick(0)) == request
        if answer is not None:
            node.take(said(answer.replace("4B 17 10 00 32", "4B 17 10 00 33")), 0)
    assert node.state is NodeState.ABSENT
    assert node.trouble == "0x1017:00 reads back 3300"


def test_a_refused_object_is_named_with_its_abort_code() -> None:
    node = keeper()
    node.tick(0)
    node.tick(0)
    node.take(said("583 80 17 10 00 02 00 01 06"), 0)
    assert node.trouble == "SDO 0x1017:00 refused with 0x06010002"


def test_the_late_answer_to_an_earlier_question_is_not_taken() -> None:
    node = keeper()
    node.tick(0)
    node.tick(0)
    node.take(said("583 60 00 18 02 00 00 00 00"), 0)
    assert node.tick(0) is None


def test_a_silent_node_is_asked_again_after_a_pause() -> None:
    node = keeper()
    node.tick(0)
    node.tick(0)
    assert node.tick(201 * MS) is None
    assert node.trouble == "no answer to SDO 0x1017:00"
    assert node.tick(500 * MS) is None
    assert hexed(node.tick(502 * MS)) == "000 80 03"


@pytest.mark.parametrize(
    ("frame", "trouble"),
    [("703 00", "booted"), ("703 7F", "NMT state 0x7F"), ("703 04", "NMT state 0x04")],
)
def test_a_node_that_leaves_operation_is_lost_at_once(frame: str, trouble: str) -> None:
    node = started()
    node.take(said(frame), 0)
    assert not node.good
    assert node.trouble == trouble
    assert hexed(node.tick(0)) == "000 80 03"


def test_three_missing_heartbeats_are_a_lost_node() -> None:
    node = started()
    assert node.tick(150 * MS) is None
    assert node.good
    node.tick(151 * MS)
    assert node.trouble == "heartbeat lost"


def test_an_emergency_stops_the_output_until_the_node_takes_it_back() -> None:
    node = started()
    node.take(said("083 10 23 11 00 00 00 00 00"), 0)  # 0x2310: continuous over-current
    assert not node.good
    assert node.trouble == "EMCY 0x2310"
    node.take(said("083 00 00 00 00 00 00 00 00"), 0)
    assert node.good


# CiA 301, emergency object: code 0 goes out when one error is gone, its register shows the rest
@each_case(
    ("later", "good"),
    [
        ("30 81 13", False),  # heartbeat lost, bits of current and communication
        ("30 81 11", False),  # a node whose register has no bit of current
        ("00 00 03", False),  # another error of current is left
        ("00 00 01", False),  # of an unknown kind
        ("00 00 91", False),  # of the maker's own
        ("00 00 11", True),  # communication alone, its generic bit with it
        ("00 00 10", True),
        ("00 00 00", True),
    ],
)
def test_an_error_of_the_node_stands_until_its_register_says_it_is_gone(
    later: str, good: bool
) -> None:
    node = started()
    node.take(said("083 10 23 03 00 00 00 00 00"), 0)
    node.take(said(f"083 {later} 00 00 00 00 00"), 0)
    assert node.good is good
    assert good or node.trouble


def test_an_emergency_about_our_absence_says_by_its_register_what_else_there_is() -> None:
    node = started()
    node.take(said("083 30 81 13 00 00 00 00 00"), 0)
    assert not node.good
    assert node.trouble == "an error is left, error register 0x13"
    node.take(said("083 00 00 11 00 00 00 00 00"), 0)
    assert node.good


def test_an_error_that_is_taken_back_while_nobody_hears_it_is_gone_after_the_next_start() -> None:
    node = started()
    node.take(said("083 10 23 03 00 00 00 00 00"), 0)
    node.tick(151 * MS)
    assert node.trouble == "heartbeat lost"
    start(node, now_ns=500 * MS)
    assert node.good


@pytest.mark.parametrize(("register", "good"), [("03", False), ("01", False), ("11", True)])
def test_an_error_from_before_the_start_is_read_from_the_node(register: str, good: bool) -> None:
    node = keeper()
    start(node, register)
    assert node.state is NodeState.OPERATIONAL
    assert node.good is good
    assert node.trouble == ("" if good else f"an error is left, error register 0x{register}")
    node.take(said("083 00 00 00 00 00 00 00 00"), 0)
    assert node.good


def test_an_emergency_about_our_own_absence_does_not_keep_us_away() -> None:
    node = started()
    node.take(said("083 50 82 11 00 00 00 00 00"), 0)
    assert node.good


def test_the_shipped_site_runs_against_the_package_s_own_nodes() -> None:
    bench = CanopenBench()
    bench.run(0.6)
    shot = bench.tick()
    assert shot.fresh
    assert bench.link.troubles == ()
    assert shot.values[1:6] == pytest.approx((90.0, 1.0, 0.15, 1.0, 95.0), abs=1e-4)
    drive = bench.device("unwind_drive")
    assert drive.number(0x6007) == 0xFFFF  # -1: offset to zero, keep running
    assert drive.number(0x1016, 1) == 100 << 16 | 80
    assert drive.number(0x1400, 5) == 80
    assert drive.number(0x1400, 2) == 1


def test_a_drive_that_was_in_error_before_the_start_is_named_until_it_is_well() -> None:
    bench = CanopenBench()
    drive = bench.device("unwind_drive")
    drive.node.set_data(0x1001, 0, b"\x03")
    bench.run(0.6)
    assert bench.tick().outcome is Outcome.NOT_CONNECTED
    assert bench.link.troubles == ("unwind_drive (node 3): an error is left, error register 0x03",)
    drive.emcy = 0x2310  # the simulated drive takes it back with the next sample
    bench.run(0.05)
    assert bench.tick().fresh


def test_sync_follows_the_process_data_of_a_tick() -> None:
    bench = CanopenBench()
    bench.run(0.6)
    bench.bus.sent.clear()
    bench.tick()
    ids = [frame.can_id for frame in bench.bus.sent if frame.can_id != 0x764]
    assert ids == [0x201, 0x203, 0x204, 0x301, 0x080]


def test_the_correction_is_the_velocity_offset_in_little_endian_counts() -> None:
    bench = CanopenBench()
    bench.run(0.6)
    bench.bus.sent.clear()
    bench.tick((-0.01234, 0.00002))
    data = {frame.can_id: frame.data for frame in bench.bus.sent}
    assert data[0x203] == (-1234).to_bytes(4, "little", signed=True)
    assert data[0x204] == bytes.fromhex("02000000")


def test_a_reset_node_is_configured_again_by_itself() -> None:
    bench = CanopenBench()
    bench.run(0.6)
    bench.fault("reset")
    bench.tick()
    assert not bench.tick().fresh
    bench.run(0.6)
    assert bench.tick().fresh
    assert [keeper.resets for keeper in bench.link.keepers] == [2, 2, 2]


def test_lost_sync_is_silence() -> None:
    bench = CanopenBench()
    bench.run(0.6)
    bench.fault("sync:0.2")
    bench.tick()
    assert bench.tick().outcome.name == "TIMEOUT"


@each_case("place", ["60B1h", "0x12", "0x1016:x", "", "0x60B1:100"])
def test_an_object_is_spelt_in_one_way(place: str) -> None:
    with pytest.raises(ConfigError):
        object_of(place)


def test_nothing_in_the_shipped_eds_is_out_of_its_object_lists() -> None:
    for name, node_id in (("euclid_drive.eds", 3), ("euclid_line.eds", 1)):
        text = (CONFIG / name).read_text()
        od = load_eds(text, name, node_id)
        listed = {
            int(line.split("=")[1], 16)
            for line in text.splitlines()
            if "=0x" in line and line.split("=")[0].isdigit()
        }
        assert {index for index in od if index >= 0x1000} == listed


@pytest.mark.parametrize(
    ("was", "now"),
    [("[1A00sub2]", "[1A00sub9]"), ("[1800sub1]", "[1800sub7]"), ("[1400sub1]", "[1400sub7]")],
)
def test_a_pdo_whose_subindices_are_missing_is_named(was: str, now: str) -> None:
    text = FILES["euclid_drive.eds"].replace(was, now)
    index = was[1:5]
    with pytest.raises(ConfigError, match=f"0x{index}:0[12] is not in the EDS"):
        network_of(SITE, FILES | {"euclid_drive.eds": text})


@pytest.mark.parametrize("frame", ["703 00", "083 01 23 00 00 00 00 00 00", "703 04"])
def test_an_extended_frame_with_the_number_of_a_node_is_not_the_node(frame: str) -> None:
    bench = CanopenBench()
    bench.run(0.6)
    assert bench.tick().fresh
    bench.bus._put([said(frame)._replace(extended=True)])
    assert bench.tick().fresh
    assert all(keeper.good for keeper in bench.link.keepers)


@pytest.mark.parametrize(
    ("frame", "word"), [("764 05", "the heartbeat of node 100"), ("080", "SYNC")]
)
def test_somebody_in_our_place_keeps_the_output_closed_and_is_named(frame: str, word: str) -> None:
    bench = CanopenBench()
    bench.run(0.6)
    assert bench.tick().fresh
    for _ in range(20):
        bench.bus._put([said(frame)])
        shot = bench.tick()
        assert shot.outcome is Outcome.NOT_CONNECTED
    assert word in bench.link.troubles[0]
    assert 0x203 in {sent.can_id for sent in bench.bus.sent}  # a fade still reaches the drives
    bench.run(0.9)
    assert not bench.tick().fresh
    bench.run(0.2)
    assert bench.tick().fresh
    assert bench.link.troubles == ()


def test_readings_behind_a_storm_of_emergencies_are_not_younger_than_they_are() -> None:
    bench = CanopenBench()
    bench.run(0.6)
    assert bench.tick().fresh
    storm = [said("083 00 00 00 00 00 00 00 00")] * 200
    ages = []
    for _ in range(10):  # two hundred each tick, between one reading and the next
        bench.bus._put(storm)
        ages.append(bench.tick().age_s)
    assert max(ages) < 0.006


def test_an_extended_sync_is_none() -> None:
    bench = CanopenBench()
    bench.run(0.6)
    bench.bus._put([said("080")._replace(extended=True)])
    assert bench.tick().fresh
