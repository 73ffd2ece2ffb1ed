from __future__ import annotations

import math
import random
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from aff_runtime.config.can_wire import can_map_of, wire_files
from aff_runtime.config.loader import load_site
from aff_runtime.fieldbus.can.dbc import can_map, load_dbc
from aff_runtime.fieldbus.can.frames import Frame
from aff_runtime.fieldbus.can.layout import CanMap
from aff_runtime.fieldbus.can.reader import CanReader, Taken
from aff_runtime.fieldbus.signal_names import SignalNames
from tests.aff_runtime.fieldbus.euclid_can import CONFIG, DATABASE, euclid_map, scan
from tests.each_case import each_case

MAP = euclid_map()


def read(reader: CanReader, frames: list[Frame]) -> Taken:
    taken = Taken.IGNORED
    for one in frames:
        taken = reader.take(one)
    return taken


def settled() -> CanReader:
    reader = CanReader(MAP)
    read(reader, scan(1))
    assert read(reader, scan(2)) is Taken.SET
    return reader


def test_hand_written_bytes_are_read_as_the_dbc_says() -> None:
    reader = CanReader(MAP)
    frames = [
        # big endian 24 bits: 0x015F90 = 90000 -> 90 N; 0xFFFA24 = -1500 -> -1.5 N; counter 0x02
        Frame(0x180, False, bytes.fromhex("015F90 FFFA24 02")),
        # little endian: 0x03F8 = 1016 -> 1.016 m/s; 0xFE0C = -500 -> -0.5 m/s; counter; 12 bits
        # each: 0x07B = 123 -> 0.0123 m/s; -200 = 0xF38 -> -0.02 m/s
        Frame(0x181, False, bytes.fromhex("F803 0CFE 02 7B80F3")),
        # 28 bits each: 0x0000123 = 291; -7 = 0xFFFFFF9 in the upper nibbles
        Frame(0x182, False, bytes.fromhex("23010090FFFFFF 02")),
        Frame(0x183, False, bytes.fromhex("00 2823 02")),  # 0x2328 = 9000 -> 90 N
        Frame(0x183, False, bytes.fromhex("01 1027 02")),  # 0x2710 = 10000 -> 200 mm
        Frame(0x184, False, bytes.fromhex("0200 2F00 2900 3412")),
    ]
    assert read(reader, frames) is Taken.SET
    count = 2.0 * math.pi / 4096.0
    wanted = (90.0, 90.0, 1.016, 0.2, -0.5, -1.5, 291 * count, -7 * count)
    assert reader.values == pytest.approx(wanted, rel=1e-12)
    assert (reader.heartbeat, reader.status, reader.roll_id) == (2, 0x2F, 41)
    assert reader.aff_echo == 0x1234
    assert reader.applied == pytest.approx((0.0123, -0.02), rel=1e-12)


def test_every_signal_reads_as_cantools_encodes_it() -> None:
    dice = random.Random(3)
    for heartbeat in range(3, 200):
        tension = round(dice.uniform(-400, 400), 3)
        angle = dice.randrange(-(2**27), 2**27)
        reader = CanReader(MAP)
        read(reader, scan(heartbeat - 1, tension_N=tension, angle=angle))
        read(reader, scan(heartbeat, tension_N=tension, angle=angle))
        assert reader.values[0] == pytest.approx(tension, abs=1e-9)
        assert reader.values[6] == pytest.approx(angle * 2 * math.pi / 4096, abs=1e-6)


def test_a_missing_frame_tears_the_set_and_the_next_scan_heals_it() -> None:
    for missing in range(3):
        reader = settled()
        frames = scan(3, tension_N=111.0)
        del frames[missing]
        assert read(reader, frames) is Taken.TORN
        assert reader.values[0] == pytest.approx(90.0)
        assert read(reader, scan(4, tension_N=111.0)) is Taken.SET
        assert reader.values[0] == pytest.approx(111.0)


def test_a_frame_of_the_scan_before_is_not_taken_for_this_one() -> None:
    reader = settled()
    frames = scan(3)
    frames[0] = scan(2, tension_N=55.0)[0]
    assert read(reader, frames) is Taken.TORN


def test_frames_out_of_order_after_the_heartbeat_tear_the_set() -> None:
    reader = settled()
    frames = scan(3)
    frames.reverse()
    assert Taken.SET not in [reader.take(one) for one in frames]


def test_a_doubled_heartbeat_is_the_same_set_again() -> None:
    reader = settled()
    frames = scan(3)
    assert read(reader, frames) is Taken.SET
    assert reader.take(frames[-1]) is Taken.SET
    assert reader.heartbeat == 3
    assert read(reader, scan(4)) is Taken.SET


def test_an_old_scan_after_a_new_one_is_dropped() -> None:
    reader = settled()
    read(reader, scan(3, tension_N=111.0))
    assert read(reader, scan(2, tension_N=55.0)) is Taken.TORN
    assert reader.values[0] == pytest.approx(111.0)
    assert reader.out_of_order == 1


def test_a_restarted_plc_is_believed_with_its_second_scan() -> None:
    reader = settled()
    for heartbeat in range(3, 40):
        read(reader, scan(heartbeat))
    assert read(reader, scan(1)) is Taken.TORN
    assert read(reader, scan(2)) is Taken.SET
    assert reader.heartbeat == 2


def test_a_wrapping_counter_goes_on_through_its_end() -> None:
    reader = CanReader(MAP)
    for heartbeat, angle in enumerate((2**27 - 2, 2**27 - 1, -(2**27), -(2**27) + 1), start=1):
        read(reader, scan(heartbeat, angle=angle))
    assert reader.values[6] == pytest.approx((2**27 + 1) * 2 * math.pi / 4096, rel=1e-12)


TURNTABLE = """VERSION "1"
BU_: PLC AFF
BO_ 384 PLC: 8 PLC
 SG_ Beat : 0|16@1+ (1,0) [0|65535] "" AFF
 SG_ Status : 16|16@1+ (1,0) [0|65535] "" AFF
 SG_ Roll : 32|16@1+ (1,0) [0|65535] "" AFF
 SG_ Angle : 48|16@1+ (0.1,0) [RANGE] "deg" AFF
BO_ 512 AFF: 6 AFF
 SG_ Beat : 0|16@1+ (1,0) [0|65535] "" PLC
 SG_ State : 16|16@1+ (1,0) [0|65535] "" PLC
 SG_ Offset : 32|16@1- (1E-05,0) [-0.3|0.3] "m/s" PLC
"""


def turntable(limits: str) -> CanReader:
    names = SignalNames(
        plc_heartbeat="PLC.Beat",
        status="PLC.Status",
        roll_id="PLC.Roll",
        channels={"angle_rad": ("PLC.Angle", math.radians(1.0), True)},
        aff_heartbeat="AFF.Beat",
        state="AFF.State",
        corrections={"unwind": ("AFF.Offset", "", 1.0)},
    )
    return CanReader(can_map(load_dbc(TURNTABLE.replace("RANGE", limits), "x.dbc"), names))


def angles_deg(reader: CanReader, counts: list[int]) -> list[float]:
    shown = []
    for heartbeat, count in enumerate(counts, start=1):
        words = (heartbeat, 0, 0, count)
        data = b"".join(word.to_bytes(2, "little") for word in words)
        assert reader.take(Frame(384, False, data)) is Taken.SET
        shown.append(math.degrees(reader.values[0]))
    return shown


@pytest.mark.parametrize("limits", ["0|359.9", "0|360"])
def test_an_angle_in_degrees_goes_on_where_its_range_ends(limits: str) -> None:
    reader = turntable(limits)
    forward = angles_deg(reader, [3500, 3590, 80, 1800, 3500, 90])
    assert forward == pytest.approx([350, 359, 368, 540, 710, 729])
    assert angles_deg(turntable(limits), [50, 3550]) == pytest.approx([5, -5])


def test_an_angle_of_all_its_bits_goes_on_where_they_end() -> None:
    for limits in ("0|6553.5", "0|0"):
        shown = angles_deg(turntable(limits), [65500, 20])
        assert shown == pytest.approx([6550.0, 6555.6])


def test_a_count_beyond_the_range_of_an_angle_is_not_a_number_and_no_turn() -> None:
    reader = turntable("0|359.9")
    shown = angles_deg(reader, [3500, 65535, 3510])
    assert math.isnan(shown[1])
    assert [shown[0], shown[2]] == pytest.approx([350, 351])


def test_an_angle_goes_on_across_a_loss() -> None:
    reader = turntable("0|359.9")
    angles_deg(reader, [3500, 100])
    reader.reset()
    assert angles_deg(reader, [200]) == pytest.approx([380])


def test_a_value_outside_the_range_of_its_signal_is_not_a_number() -> None:
    reader = settled()
    frames = scan(3)
    frames[0] = Frame(0x180, False, bytes.fromhex("7FFFFF 000000 03"))  # 8388.607 N > 8388 N
    assert read(reader, frames) is Taken.SET
    assert math.isnan(reader.values[0])
    assert reader.values[5] == 0.0


@each_case("length", [0, 1, 6, 8])
def test_a_frame_of_wrong_length_is_bad(length: int) -> None:
    reader = settled()
    assert reader.take(Frame(0x180, False, bytes(length))) is Taken.BAD


def test_an_extended_frame_with_the_same_number_is_another_frame() -> None:
    reader = settled()
    assert reader.take(Frame(0x180, True, bytes(7))) is Taken.IGNORED


@given(
    st.lists(
        st.tuples(
            st.sampled_from([0x180, 0x181, 0x182, 0x183, 0x184, 0x7FF]), st.binary(max_size=8)
        ),
        max_size=60,
    )
)
def test_no_stream_of_frames_crashes_or_yields_a_torn_value(
    stream: list[tuple[int, bytes]],
) -> None:
    reader = CanReader(MAP)
    last: dict[int, bytes] = {}
    for can_id, data in stream:
        taken = reader.take(Frame(can_id, False, data))
        if taken in (Taken.STORED, Taken.SET):
            last[can_id] = data
        if taken is Taken.SET:
            low = reader.heartbeat & 0xFF
            assert [last[0x180][6], last[0x181][4], last[0x182][7]] == [low] * 3
            raw = DATABASE.decode_message(0x180, last[0x180], decode_choices=False)
            assert isinstance(raw, dict)
            shown = reader.values[0]
            assert math.isnan(shown) or shown == pytest.approx(raw["UnwindTension"])


def test_the_map_refuses_a_signal_that_is_not_there() -> None:
    from aff_runtime.base.errors import ConfigError
    from aff_runtime.fieldbus.can.dbc import _find

    with pytest.raises(ConfigError, match="has no such signal; it has PlcHeartbeat"):
        _find(DATABASE, "PLC_STATUS.Nothing")


@pytest.mark.parametrize("step", [5, 10, 50])
def test_a_restarted_plc_that_sends_some_scans_only_is_believed_as_soon(step: int) -> None:
    reader = CanReader(MAP)
    for heartbeat in (20000, 20001):
        read(reader, scan(heartbeat))
    assert read(reader, scan(step)) is Taken.TORN
    assert read(reader, scan(2 * step + 1)) is Taken.SET


def without_pullroll() -> CanMap:
    """The shipped map with all that PLC_TENSION carries for the record alone."""
    return replace(MAP, recorded_only=frozenset({"unwind_tension_N", "pullroll_tension_N"}))


def test_a_frame_for_the_record_alone_that_stays_away_is_nan_and_tears_no_set() -> None:
    reader = CanReader(without_pullroll())
    names = [channel.name for channel in MAP.channels]
    read(reader, scan(1))
    assert read(reader, scan(2, tension_N=90.0)) is Taken.SET
    torn = reader.torn  # the first has one page of two
    assert reader.values[names.index("unwind_tension_N")] == pytest.approx(90.0)
    for heartbeat in (3, 4):
        others = [f for f in scan(heartbeat) if f.can_id != 0x180]
        assert read(reader, others) is Taken.SET
        assert math.isnan(reader.values[names.index("unwind_tension_N")])
        assert reader.values[names.index("line_speed_m_s")] == pytest.approx(1.016)
    assert read(reader, scan(5, tension_N=91.0)) is Taken.SET
    assert reader.values[names.index("unwind_tension_N")] == pytest.approx(91.0)
    assert reader.torn == torn


def test_a_frame_for_the_record_alone_of_another_scan_is_nan() -> None:
    reader = CanReader(without_pullroll())
    read(reader, scan(1))
    read(reader, scan(2))
    late = [scan(2)[0], *scan(3)[1:]]  # its counter says 2
    assert read(reader, late) is Taken.SET
    assert math.isnan(reader.values[0])


def test_the_same_frame_tears_the_set_where_a_correction_waits_for_it() -> None:
    half = replace(MAP, recorded_only=frozenset({"pullroll_tension_N"}))
    for shown in (MAP, half):
        reader = CanReader(shown)
        read(reader, scan(1))
        read(reader, scan(2))
        assert read(reader, scan(3)[1:]) is Taken.TORN


def paged(pages: int) -> CanReader:
    """A reader of the shipped map whose PLC_SLOW has ``pages`` pages, of which two are mapped."""
    more = "".join(
        f' SG_ Other{page} m{page} : 8|16@1+ (1,0) [0|65535] "" AFF\n' for page in range(2, pages)
    )
    text = (CONFIG / "euclid.dbc").read_text()
    first = text.index("\n", text.index("BO_ 387 ")) + 1  # 0x183
    site = load_site(CONFIG / "euclid_can.yaml")
    files = wire_files(site, CONFIG) | {"euclid.dbc": text[:first] + more + text[first:]}
    return CanReader(can_map_of(site, files))


@pytest.mark.parametrize("pages", [2, 5, 12])
def test_a_plc_that_goes_round_pages_which_nobody_reads_tears_no_set(pages: int) -> None:
    reader = paged(pages)
    taken = []
    for heartbeat in range(1, 6 * pages):
        frames = scan(heartbeat)
        page = heartbeat % pages
        low = heartbeat & 0xFF
        if page > 1:
            frames[3] = Frame(0x183, False, bytes((page, 0x55, 0x55, low)))
        else:
            value = {0: "2823", 1: "1027"}[page]
            frames[3] = Frame(0x183, False, bytes.fromhex(f"{page:02x}{value}{low:02x}"))
        taken.append(read(reader, frames))
    assert taken[pages:] == [Taken.SET] * (len(taken) - pages)
    assert reader.values[1] == pytest.approx(90.0)
    late = [read(reader, [f for f in scan(h) if f.can_id != 0x183]) for h in range(100, 300)]
    assert Taken.TORN in late[: 2 * pages + 1]
    assert set(late[2 * pages + 1 :]) == {Taken.TORN}
