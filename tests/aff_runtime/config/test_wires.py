"""Sites on other wires than Modbus TCP: what is refused, and what it costs on the bus."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from aff_runtime.base.errors import ConfigError
from aff_runtime.config.can_wire import can_map_of, load_share, wire_files
from aff_runtime.config.check import check_site
from aff_runtime.config.loader import load_site
from aff_runtime.config.models.gateway import WIRES
from aff_runtime.config.plain_file import MAX_BYTES
from aff_runtime.config.wire_table import wire_lines
from tests.aff_runtime.config.shipped import EUCLID

CONFIG = EUCLID.parent


def refused(path: Path, old: str, new: str) -> str:
    text = path.read_text()
    assert text.count(old) >= 1, old
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(ConfigError) as caught:
        load_site(path)
    return str(caught.value)


def test_the_shipped_sites_agree_but_for_their_wires() -> None:
    sites = [load_site(CONFIG / f"euclid{end}.yaml") for end in ("", "_can", "_canopen")]
    apart = {"line", "gateway", "actuators"}
    plain = [site.model_dump(exclude=apart) for site in sites]
    assert plain[0] == plain[1] == plain[2]
    limits = [[(a.limit, a.slew, a.blocks) for a in site.actuators.values()] for site in sites]
    assert limits[0] == limits[1] == limits[2]


def test_the_load_of_the_bus_is_the_sum_of_the_longest_frames() -> None:
    site = load_site(CONFIG / "euclid_can.yaml")
    share = load_share(site, can_map_of(site, wire_files(site, CONFIG)))
    # bits by length: 34 + 8 n + 13 + (34 + 8 n - 1) // 4
    bits = {4: 95, 5: 105, 6: 115, 7: 125, 8: 135}
    total = sum(bits[n] for n in (7, 8, 8, 4, 8, 8, 5, 6))
    assert share == pytest.approx(total / (500_000 * 0.005))


@pytest.mark.parametrize("name", ["euclid_can.yaml", "euclid_canopen.yaml"])
def test_a_bus_that_is_too_slow_is_refused(folder: Path, name: str) -> None:
    said = refused(folder / name, "bitrate: 500000", "bitrate: 250000")
    assert "% of 250000 bit/s each 5 ms (worst-case stuffing); at most 50%" in said


def test_two_wires_are_one_too_many(folder: Path) -> None:
    path = folder / "euclid.yaml"
    said = refused(
        path,
        "  address_base: 0\n",
        "  can_dbc: { channel: can0, dbc: euclid.dbc }\n  address_base: 0\n",
    )
    assert f"give exactly one of {', '.join(WIRES)}" in said


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("PLC_STATUS.RollId", "PLC_STATUS.Roll", "PLC_STATUS has no such signal; it has"),
        ("signal: PLC_STATUS.Status", "register: 3", "signal is missing; can_dbc needs it"),
        ("dbc: euclid.dbc", "dbc: gone.dbc", "cannot be read"),
        ("scale: 0.00001,", "scale: 0.00002,", "AFF_UNWIND.Unwind has 0.00001 per count"),
        (
            "AFF_INFO.Echo",
            "PLC_STATUS.Status",
            "PLC_STATUS is read as well, and a frame has one sender",
        ),
    ],
)
def test_a_site_that_the_dbc_contradicts_is_refused(
    folder: Path, old: str, new: str, text: str
) -> None:
    assert text in refused(folder / "euclid_can.yaml", old, new)


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("unwind_drive.0x60B1", "unwind_drive.0x60B2", "no RPDO of euclid_drive.eds maps this"),
        ("node: 4,", "node: 3,", "node id 3 is taken by unwind_drive"),
        ('object: "0x6007"', 'object: "0x60077"', "write an object as 0x60B1"),
        ("#lost_after_ms: 80", "lost_after_ms: 50", "Write 60 or more, or lower heartbeat_ms"),
        # a beat leaves with a tick: 20 ms of heartbeat are 2 ticks of 15 ms, and 3 x 30 > 80
        ("cycle_ms: 5", "cycle_ms: 15", "30 ms with the ticks of cycle_ms 15. Write 90 or more"),
    ],
)
def test_a_site_that_the_eds_contradicts_is_refused(
    folder: Path, old: str, new: str, text: str
) -> None:
    assert text in refused(folder / "euclid_canopen.yaml", old, new)


def lines_of(path: Path, *texts: str) -> list[int]:
    lines = path.read_text().splitlines()
    return [next(i for i, line in enumerate(lines, 1) if text in line) for text in texts]


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("euclid_can.yaml", "PLC_MOTION.LineSpeed", "PLC_MOTION.LineSped"),
        ("euclid_can.yaml", "PLC_SLOW.UnwindRadius", "PLC_SLO.UnwindRadius"),
        ("euclid_can.yaml", "dbc: euclid.dbc", "dbc: gone.dbc"),
        ("euclid_canopen.yaml", "unwind_drive.0x606C", "unwind_drive.0x606D"),
        ("euclid_canopen.yaml", "unwind_drive.0x2011", "unwnd_drive.0x2011"),
        ("euclid_canopen.yaml", "eds: euclid_line.eds", "eds: gone.eds"),
        ("euclid_canopen.yaml", 'object: "0x6007"', 'object: "0x7007"'),
    ],
)
def test_what_the_files_of_the_wire_do_not_hold_is_found_where_the_site_says_it(
    folder: Path, name: str, old: str, new: str
) -> None:
    path = folder / name
    said = refused(path, old, new)
    (line,) = lines_of(path, new)
    assert f"{name}:{line}:" in said


def test_a_reading_mapped_twice_is_refused_as_two_registers_in_one_place_are(folder: Path) -> None:
    path = folder / "euclid_can.yaml"
    said = refused(path, "PLC_TENSION.PullrollTension", "PLC_TENSION.UnwindTension")
    assert "PLC_TENSION.UnwindTension: is read twice" in said
    assert f":{lines_of(path, 'pullroll_tension_N: {')[0]}:" in said


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("BO_ 385 PLC_MOTION", "BO_ 384 PLC_MOTION", "both have the identifier 0x180"),
        ("BO_ 385 PLC_MOTION", "BO_ 385 PLC_TENSION", "two messages are called PLC_TENSION"),
    ],
)
def test_two_messages_that_cannot_be_told_apart_are_refused(
    folder: Path, old: str, new: str, text: str
) -> None:
    dbc = folder / "euclid.dbc"
    dbc.write_text(dbc.read_text().replace(old, new, 1))
    with pytest.raises(ConfigError, match=text):
        load_site(folder / "euclid_can.yaml")


HEARTBEAT = "SG_ PlcHeartbeat : 0|16@1+"


@pytest.mark.parametrize(
    ("edits", "at", "text"),
    [
        (
            [(HEARTBEAT, "SG_ PlcHeartbeat : 0|4@1+")],
            "PLC_STATUS.PlcHeartbeat",
            "has 4 bits and starts over after 16 scans. Within the time in which the PLC must",
        ),
        (
            [("SG_ AffHeartbeat : 0|16@1+", "SG_ AffHeartbeat : 0|8@1+")],
            "AFF_UNWIND.AffHeartbeat",
            "has 8 bits. The PLC's half (AFF_GATEWAY) tells a second master by a jump",
        ),
        (
            [
                (HEARTBEAT, "SG_ PlcHeartbeat : 0|8@1+"),
                ("BO_ 387 PLC_SLOW: 4", "BO_ 387 PLC_SLOW: 5"),
                ("SG_ Counter : 24|8@1+ (1,0) [0|255]", "SG_ Counter : 24|16@1+ (1,0) [0|65535]"),
            ],
            "",
            "PLC_SLOW.Counter: has 16 bits, but repeats the low bits of PLC_STATUS.PlcHeartbeat",
        ),
    ],
)
def test_a_heartbeat_that_starts_over_too_soon_is_refused(
    folder: Path, edits: list[tuple[str, str]], at: str, text: str
) -> None:
    dbc, site = folder / "euclid.dbc", folder / "euclid_can.yaml"
    for old, new in edits:
        assert old in dbc.read_text()
        dbc.write_text(dbc.read_text().replace(old, new, 1))
    with pytest.raises(ConfigError) as caught:
        load_site(site)
    assert text in str(caught.value)
    if at:
        assert f":{lines_of(site, at)[0]}:" in str(caught.value)


def test_a_heartbeat_of_eight_bits_will_do(folder: Path) -> None:
    dbc = folder / "euclid.dbc"
    dbc.write_text(dbc.read_text().replace(HEARTBEAT, "SG_ PlcHeartbeat : 0|8@1+", 1))
    assert load_site(folder / "euclid_can.yaml").gateway.can_dbc is not None


def test_the_selector_of_a_multiplexed_message_is_no_value(folder: Path) -> None:
    path = folder / "euclid_can.yaml"
    said = refused(path, "PLC_SLOW.TensionRef", "PLC_SLOW.Page")
    assert "PLC_SLOW.Page: says which signals PLC_SLOW carries in this frame" in said
    assert "name one of TensionRef, UnwindRadius" in said
    assert f":{lines_of(path, 'PLC_SLOW.Page')[0]}:" in said


def test_two_nodes_whose_eds_give_one_identifier_are_refused(folder: Path) -> None:
    eds = folder / "euclid_drive.eds"
    assert "$NODEID+0x180" in eds.read_text()
    eds.write_text(eds.read_text().replace("$NODEID+0x180", "0x183"))
    with pytest.raises(ConfigError, match="both have the identifier 0x183"):
        load_site(folder / "euclid_canopen.yaml")


@pytest.mark.parametrize(
    ("name", "line"),
    [
        ("euclid.yaml", "1 transaction(s) per tick of 5 ms"),
        ("euclid_can.yaml", "bus load 39.2% of 500000 bit/s each 5 ms"),
    ],
)
def test_the_check_says_what_a_cycle_costs_on_the_bus(name: str, line: str) -> None:
    lines = check_site(CONFIG / name).lines()
    assert line in lines
    assert not any("0..-1" in text for text in lines)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "cp1252"])
def test_a_dbc_with_a_degree_sign_is_read_in_the_encodings_of_its_editors(
    folder: Path, encoding: str
) -> None:
    dbc = folder / "euclid.dbc"
    old = '[0|65535] "" AFF'
    assert old in dbc.read_text()
    dbc.write_bytes(dbc.read_text().replace(old, '[0|65535] "\u00b0C" AFF', 1).encode(encoding))
    assert load_site(folder / "euclid_can.yaml").gateway.can_dbc is not None


def test_an_object_that_a_pdo_maps_and_the_eds_forgets_is_refused(folder: Path) -> None:
    eds = folder / "euclid_drive.eds"
    eds.write_text(eds.read_text().replace("[60B1]", "[60B2]"))
    with pytest.raises(ConfigError, match=r"a PDO of euclid_drive\.eds maps this object, but"):
        load_site(folder / "euclid_canopen.yaml")


def test_rubbish_in_the_place_of_the_dbc_is_refused(folder: Path) -> None:
    (folder / "euclid.dbc").write_bytes(bytes(range(256)))
    with pytest.raises(ConfigError):
        load_site(folder / "euclid_can.yaml")


def test_a_serial_line_that_is_too_slow_is_refused(folder: Path) -> None:
    text = (folder / "euclid.yaml").read_text()
    begin, end = text.index("  modbus_tcp:"), text.index("  # 0: the numbers below")
    rtu = "  modbus_rtu: { device: /dev/ttyS0, baud: BAUD, deadline_ms: 15 }\n"
    path = folder / "euclid.yaml"
    slow = text[:begin] + rtu + text[end:]
    slow = slow.replace("cycle_ms: 5", "cycle_ms: 20").replace("_after_ms: 15", "_after_ms: 40")
    path.write_text(slow.replace("BAUD", "38400"))
    with pytest.raises(ConfigError, match=r"one cycle's frames take 24\.7 ms at 38400 bit/s"):
        load_site(path)
    path.write_text(slow.replace("BAUD", "115200"))
    assert "1 transaction(s) per tick of 20 ms" in list(wire_lines(load_site(path), folder))


@pytest.mark.parametrize("name", ["euclid.yaml", "euclid_can.yaml", "euclid_canopen.yaml"])
def test_the_map_names_every_channel_and_correction(name: str) -> None:
    site = load_site(CONFIG / name)
    text = "\n".join(wire_lines(site, CONFIG))
    for wanted in (*site.gateway.read.channels, *site.actuators):
        assert wanted in text


def test_the_map_on_can_shows_all_that_the_plc_must_fill_in() -> None:
    lines = list(wire_lines(load_site(CONFIG / "euclid_can.yaml"), CONFIG))
    rows = [line.split() for line in lines]
    # PLC_TENSION of euclid.dbc: 7|24@0- from the top of 56 bits, so 56 - 24 = 32 below it
    assert any(" ".join(row).startswith("24 bits >> 32 Motorola signed Unwi") for row in rows)
    for frame, counter in (("PLC_TENSION", "PlcHeartbeat"), ("AFF_FOLLOWER", "AffHeartbeat")):
        begin = next(i for i, row in enumerate(rows) if row[-1:] == [frame])
        assert rows[begin + 1][6:8] == ["Counter", "repeats"]
        assert rows[begin + 1][-1].endswith(f".{counter}")
    assert sum("says which page" in line for line in lines) == 2
    assert "PLC_STATUS closes a scan: the PLC sends it last" in lines
    assert any("ones complement of Unwind" in line for line in lines)


@pytest.mark.parametrize(
    ("name", "said"),
    [
        # 1000 counts of 0.02 mm; of 0.001 N; of 0.00001 m/s
        ("euclid.yaml", [f"1000 counts = {si} " for si in ("0.02 m", "1 N", "0.01 m/s")]),
        ("euclid_can.yaml", ["unwind_radius_m, 1000 counts = 0.02 m", "1000 counts = 0.01 m/s"]),
        (
            "euclid_canopen.yaml",
            [
                "unwind_radius_m, 1000 counts = 0.02 m",
                "0x2100",
                "unwind_tension_N, 1000 counts = 1 N",
                "aff_heartbeat",
            ],
        ),
    ],
)
def test_the_map_shows_counts_in_the_units_of_the_line(name: str, said: list[str]) -> None:
    text = "\n".join(wire_lines(load_site(CONFIG / name), CONFIG))
    for wanted in said:
        assert wanted in text


def test_the_map_shows_an_offset(folder: Path) -> None:
    dbc = folder / "euclid.dbc"
    old = "SG_ LineSpeed : 0|16@1- (0.001,0)"
    assert old in dbc.read_text()
    dbc.write_text(dbc.read_text().replace(old, old.replace(",0)", ",-2)")))
    text = "\n".join(wire_lines(load_site(folder / "euclid_can.yaml"), folder))
    assert "line_speed_m_s, 1000 counts = 1 m/s, 0 = -2 m/s" in text


UNWIND = "SG_ Unwind : 32|16@1- (1E-05,0) [-0.32767|0.32767]"


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        # zero would go out as 0.1 m/s: sent counts are clipped to the stated range
        (UNWIND, UNWIND.replace("-0.32767|", "0.1|"), "a correction has a sign and rests at 0"),
        (UNWIND, UNWIND.replace("-0.32767|", "0|"), "a correction has a sign and rests at 0"),
        (UNWIND, UNWIND.replace("-0.32767|0.32767", "0.3|-0.3"), "no value is in it"),
        (UNWIND, UNWIND.replace("1E-05,0", "1E-05,0.000004"), "no count of it is zero"),
        (UNWIND, UNWIND.replace("0.32767", "0.001"), "0.15 m/s does not fit AFF_UNWIND.Unwind"),
        ('Page M : 0|8@1+ (1,0) [0|255] "" AFF', 'Page M : 0|1@1+ (1,0) [0|1] "" AFF', ""),
        ("TensionRef m0", "TensionRef m300", "its page 300 can never be shown"),
        ("[-32.768|32.767]", "[32|-32]", "its range is 32 to -32; no value is in it"),
        ("BO_ 388 PLC_STATUS: 8", "BO_ 388 PLC_STATUS: 12", "has 12 bytes; a classic CAN frame"),
        ("BO_ 388 PLC_STATUS: 8", "BO_ 388 PLC_STATUS: 64", "has 64 bytes; a classic CAN frame"),
    ],
)
def test_a_dbc_that_cannot_carry_what_the_site_wants_is_refused(
    folder: Path, old: str, new: str, text: str
) -> None:
    dbc = folder / "euclid.dbc"
    assert old in dbc.read_text()
    dbc.write_text(dbc.read_text().replace(old, new, 1))
    if not text:  # two pages fit one bit
        load_site(folder / "euclid_can.yaml")
        return
    with pytest.raises(ConfigError) as caught:
        load_site(folder / "euclid_can.yaml")
    assert text in str(caught.value)


@pytest.mark.parametrize("kind", ["pipe", "device", "too large"])
def test_what_never_ends_is_no_description_of_a_wire(folder: Path, kind: str) -> None:
    path = folder / "euclid.dbc"
    path.unlink()
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    else:
        with path.open("wb") as stream:
            stream.truncate(MAX_BYTES + 1)
    with pytest.raises(
        ConfigError, match="is larger than 1 MB" if kind == "too large" else "file"
    ):
        load_site(folder / "euclid_can.yaml")


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ("$NODEID+0x180", "0x080", "its PDO has the identifier 0x80; a PDO's is 0x181 to 0x57F"),
        ("$NODEID+0x180", "0x764", "its PDO has the identifier 0x764"),
        ("$NODEID+0x180", "0x20000190", "its PDO has the identifier 0x20000190"),
        ("0x606C0020", "0x606C0010", "16 bits of it are mapped, but it has 32"),
    ],
)
def test_an_eds_whose_pdo_cannot_be_is_refused(
    folder: Path, old: str, new: str, text: str
) -> None:
    eds = folder / "euclid_drive.eds"
    assert eds.read_text().count(old) == 1
    eds.write_text(eds.read_text().replace(old, new))
    with pytest.raises(ConfigError) as caught:
        load_site(folder / "euclid_canopen.yaml")
    assert text in str(caught.value)
