"""What a site file and the files it names may cost: little, whatever they say."""

from __future__ import annotations

import itertools
import os
import re
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, cast

import pytest

from aff_runtime.app.check.validate import check_result, parameter_record
from aff_runtime.app.wiring.shape_file import MAX_FILE_BYTES, read_shapes
from aff_runtime.base.errors import ConfigError
from aff_runtime.config.check import check_site
from aff_runtime.config.learned_responses import learned_responses
from aff_runtime.config.loader import read_site
from aff_runtime.config.plain_file import MAX_BYTES, read_plain
from aff_runtime.config.yaml_marks import parse_marked
from aff_runtime.fieldbus.can.dbc import load_dbc
from aff_runtime.fieldbus.canopen.eds_file import MOST_ODD_LINES, load_eds
from tests.aff_runtime.config.shipped import copied, edited
from tests.each_case import each_case

ROOT = Path(__file__).parents[2]
SITE = ROOT / "config" / "euclid.yaml"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with copies of every shipped site file and wire file."""
    return cast(Path, copied(tmp_path))


# --- the site file itself ---------------------------------------------------------------------


def keys(count: int) -> str:
    return "".join(f"  k{i}: 1\n" for i in range(count))


def nine_of_nine(first: str, opening: str, closing: str) -> str:
    """Return 19 levels, each of nine aliases of the one before."""
    levels = [first]
    for i in range(1, 19):
        aliases = ", ".join(f"*l{i - 1}" for _ in range(9))
        levels.append(f"l{i}: &l{i} {opening}{aliases}{closing}\n")
    return "".join(levels)


_LETTERS = itertools.count()


def _with_a_key(alias: re.Match[str]) -> str:
    return f"k{next(_LETTERS)}: {alias[0]}"


UNFOLDS = "aliases unfold to too much. Write it out."
BOMBS = {
    "a section merged into itself": ("z: &z {<<: *z}\n", f"f:1:4  z: {UNFOLDS}"),
    "three times itself": ("z: &z {<<: [*z, *z, *z]}\n", f"f:1:12  z: {UNFOLDS}"),
    "merged into its own value": ("z: &z {<<: *z, a: *z}\n", UNFOLDS),
    "merges of nothing": (nine_of_nine("l0: &l0 {}\n", "{<<: [", "]}"), UNFOLDS),
    "merges of merges": (nine_of_nine("l0: &l0 {a: 1}\n", "{<<: [", "]}"), UNFOLDS),
    "lists of lists": (nine_of_nine("l0: &l0 [1]\n", "[", "]"), UNFOLDS),
    "sections of sections": (
        re.sub(r"\*l(\d+)", _with_a_key, nine_of_nine("l0: &l0 {a: 1}\n", "{", "}")),
        UNFOLDS,
    ),
    "too many merges": (
        "a: &a {x: 1}\n" + "".join(f"b{i}: {{<<: *a}}\n" for i in range(6000)),
        "holds over 20000 values",
    ),
    "a list that is merged": ("a: &a [1]\nb: {<<: [*a, *a]}\n", "f:2:9  b: `<<` takes a section"),
}


@pytest.mark.parametrize("name", BOMBS)
def test_what_unfolds_without_end_is_refused_in_one_sentence(name: str) -> None:
    text, said = BOMBS[name]
    before_s = time.process_time()
    with pytest.raises(ConfigError) as caught:
        parse_marked(text.encode(), "f")
    assert said in str(caught.value)
    assert re.match(r"f:\d+:\d+  ", str(caught.value))
    assert "\n" not in str(caught.value)
    assert time.process_time() - before_s < 3.0  # of our own processor time, not of the clock


def test_a_merge_of_nine_thousand_keys_takes_what_reading_them_takes() -> None:
    text = f"a: &a\n{keys(9000)}b:\n  <<: *a\n  k0: 2\n"
    before_s = time.process_time()
    tree = parse_marked(text.encode(), "f")
    assert time.process_time() - before_s < 3.0  # every mark was looked at for every key: 9 s
    merged = cast(dict[str, Any], tree.values["b"])
    assert (len(merged), merged["k0"], merged["k8999"]) == (9000, 2, 1)
    assert tree.marks["b", "k8999"].line == 9001
    assert tree.marks["b", "k0"].line == 9004


def test_merges_in_a_chain_are_read_up_to_the_depth_of_a_file() -> None:
    text = "l0: &l0 {a: 1, deep: {b: 2}}\n"
    text += "".join(f"l{i}: &l{i} {{<<: *l{i - 1}}}\n" for i in range(1, 15))
    tree = parse_marked(text.encode(), "f")
    assert tree.values["l14"] == {"a": 1, "deep": {"b": 2}}
    assert tree.marks["l14", "deep", "b"].line == 1


TEXT = '"' + "x" * 200_000 + '"'
SPOILT: dict[str, Callable[[bytes], bytes]] = {
    "a section thirty deep": lambda raw: raw + b"deep: " + b"{a: " * 30 + b"1" + b"}" * 30 + b"\n",
    "19 900 values": lambda raw: raw + b"many: [" + b"1, " * 19_900 + b"1]\n",
    "a text of 200 kB": lambda raw: raw.replace(b"name: Euclid", f"name: {TEXT}".encode(), 1),
    "a number of 23 digits": lambda raw: raw.replace(b"port: 5020", b"port: " + b"9" * 23, 1),
    "a number of 5000 digits": lambda raw: raw.replace(b"port: 5020", b"port: " + b"9" * 5000, 1),
    "a hex number that is too long": lambda raw: raw.replace(
        b"port: 5020", b"port: 0x" + b"f" * 9
    ),
    "an escape character": lambda raw: raw.replace(b"name: Euclid", b'name: "a\\eb"', 1),
    "a zero byte": lambda raw: raw.replace(b"name: Euclid", b"name: a\0b", 1),
    "UTF-16": lambda raw: raw.decode().encode("utf-16"),
    "Latin-1": lambda raw: raw.replace(b"name: Euclid", "name: Eukl\u00edd".encode("latin-1"), 1),
    "two documents": lambda raw: raw + b"---\nversion: 1\n",
    "a directive": lambda raw: b"%YAML 9.9\n---\n" + raw,
    "an unknown directive's tag": lambda raw: (
        b"%TAG ! tag:yaml.org,2002:python/\n--- !name:x\n1\n"
    ),
    "a Python tag": lambda raw: raw.replace(b"name: Euclid", b"name: !!python/name:os.system x"),
    "an unknown alias": lambda raw: raw.replace(b"name: Euclid", b"name: *base", 1),
    "nothing": lambda _: b"",
    "256 kB and one byte": lambda raw: raw.ljust(256 * 1024 + 1, b"#"),
}


@pytest.mark.parametrize("name", SPOILT)
def test_a_spoilt_site_file_is_refused_at_a_place(tmp_path: Path, name: str) -> None:
    path = tmp_path / "site.yaml"
    path.write_bytes(SPOILT[name](SITE.read_bytes()))
    report = check_site(path)
    assert not report.ok
    for finding in report.errors:
        assert str(finding).startswith(f"{path}:{finding.line}:{finding.column}  ")
        assert str(finding).isprintable()
        assert len(str(finding)) < 700


def _pipe(path: Path) -> None:
    os.mkfifo(path)


NO_FILES: dict[str, Callable[[Path], None]] = {
    "a pipe": _pipe,
    "a folder": Path.mkdir,
    "a device": lambda path: path.symlink_to("/dev/zero"),
    "memory of a process": lambda path: path.symlink_to("/proc/self/mem"),
    "a link to itself": lambda path: path.symlink_to(path),
    "a link to nothing": lambda path: path.symlink_to(path.with_name("gone")),
}


@pytest.mark.parametrize("kind", NO_FILES)
def test_what_is_no_file_is_no_site_file(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "site.yaml"
    NO_FILES[kind](path)
    (finding,) = check_site(path).errors
    assert (finding.line, finding.column) == (1, 1)
    assert "cannot be read: " in finding.text


def test_the_record_holds_the_very_bytes_that_were_checked(tmp_path: Path) -> None:
    path = edited(tmp_path)
    text = "\ufeff" + path.read_text().replace("\n", "\r\n")
    path.write_bytes(text.encode())
    reading = read_site(path)
    path.write_text("another: text\n")  # between the check and the record
    assert parameter_record(path, reading, learned_responses(reading, tmp_path)).site_text == text


# --- files that the site names ----------------------------------------------------------------

TLS = "    tls: { ca: ca.pem, certificate: aff.pem, private_key: aff.key, crl: crl.pem }"
NAMED = {
    "ca.pem": ("euclid.yaml", "gateway.modbus_tcp.tls.ca", MAX_BYTES),
    "aff.pem": ("euclid.yaml", "gateway.modbus_tcp.tls.certificate", MAX_BYTES),
    "aff.key": ("euclid.yaml", "gateway.modbus_tcp.tls.private_key", MAX_BYTES),
    "crl.pem": ("euclid.yaml", "gateway.modbus_tcp.tls.crl", MAX_BYTES),
    "euclid.dbc": ("euclid_can.yaml", "gateway.can_dbc.dbc", MAX_BYTES),
    "euclid_drive.eds": ("euclid_canopen.yaml", "gateway.canopen_402.nodes", MAX_BYTES),
    "learned/euclid_unwind.json": ("euclid.yaml", "actuators.unwind.response", 1 << 24),
}


def _too_large(path: Path, size: int) -> None:
    with path.open("wb") as stream:
        stream.truncate(size + 1)


@pytest.mark.parametrize("kind", ["a pipe", "a folder", "too large"])
@pytest.mark.parametrize("name", NAMED)
def test_what_does_not_end_is_refused_wherever_the_site_names_it(
    folder: Path, name: str, kind: str
) -> None:
    site, key, size = NAMED[name]
    if name.endswith((".pem", ".key")):
        text = (folder / site).read_text().replace("    port: 5020", f"    port: 5020\n{TLS}", 1)
        (folder / site).write_text(text)
        for other in ("ca.pem", "aff.pem", "aff.key", "crl.pem"):
            (folder / other).write_text("none\n")
    (folder / "learned").mkdir()
    (folder / name).unlink(missing_ok=True)
    if kind == "too large":
        _too_large(folder / name, size)
    else:
        NO_FILES[kind](folder / name)
    said = check_result(folder / site)
    assert said.parameters is None
    (finding,) = [line for line in said.findings if f"  {key}" in line]
    assert re.match(rf"{folder / site}:\d+:\d+  ", finding)
    wanted = {"a pipe": "not a file", "a folder": "Is a directory", "too large": "larger|too long"}
    assert re.search(wanted[kind], finding), finding


@pytest.mark.parametrize("kind", ["a pipe", "a folder", "too large"])
def test_what_does_not_end_is_no_learned_shape(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "x.shape.json"
    if kind == "too large":
        _too_large(path, MAX_FILE_BYTES)
    else:
        NO_FILES[kind](path)
    texts, (fault,) = read_shapes({"unwind": path})
    assert not texts
    assert "the roll is learned anew" in fault


@pytest.mark.parametrize("name", ["/dev/zero", "/dev/null"])
def test_a_device_is_not_opened(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "open", None)  # opening alone can set one off
    with pytest.raises(ValueError, match="is not a file"):
        read_plain(Path(name))


def test_a_file_that_grows_while_it_is_read_is_not_followed() -> None:
    with pytest.raises(ValueError, match="is larger than 4 kB"):
        read_plain(Path("/proc/self/smaps"), 4096)  # says that its size is 0


# --- numbers of DBC and EDS files -------------------------------------------------------------

HEAD = 'VERSION ""\nBU_: PLC\n'


def message(length: str, *signals: str) -> str:
    return f"{HEAD}BO_ 1280 B: {length} PLC\n" + "".join(f" SG_ {s}\n" for s in signals)


def signal_of(place: str, name: str = "S") -> str:
    return f'{name} : {place}@1+ (1,0) [0|0] "" PLC'


PAGED = message("8", signal_of("0|8", "M M"), signal_of("8|8", "S m0"))
DBC = {
    "65 bytes": (message("65"), "x.dbc:3: message B of 65 bytes; a frame has 64 at most"),
    "100 MB in 60 bytes": (message("100000000"), "message B of 100000000 bytes"),
    "10^30 bytes": (message("1" + "0" * 30), "message B of 10000000000000000000 bytes"),
    "a comment in between": (message("// one\n 65"), "x.dbc:3: message B of 65 bytes"),
    "right after a comment's key": (f'{HEAD}CM_ BO_ 1 "x";BO_ 1280 B: 65 PLC\n', "x.dbc:3: mess"),
    "in the shadow of NS_": ("NS_ :\n SG_MUL_VAL_\n BO_\n" + message("65"), "x.dbc:6: message B"),
    "513 bits": (message("8", signal_of("0|513")), "x.dbc:4: signal S of 513 bits from bit 0 on"),
    "10^8 bits": (message("8", signal_of("0|100000000")), "signal S of 100000000 bits"),
    "first bit 512": (message("8", signal_of("512|8")), "signal S of 8 bits from bit 512 on"),
    "first bit -10^8": (message("8", signal_of("-100000000|8")), "from bit -100000000 on"),
    "of a page": (message("8", signal_of("0|8", "M M"), signal_of("8|513", "S m0")), "x.dbc:5: "),
    "0 bits": (message("8", signal_of("0|0")), "length 0 is not greater than 0"),
    "a signal that does not fit": (message("8", signal_of("60|8")), "does not fit"),
    "10^9 pages": (f"{PAGED}SG_MUL_VAL_ 1280 S M 0-999999999;\n", "x.dbc:6: its multiplexers"),
    "without a minus": (f"{PAGED}SG_MUL_VAL_ 1280 S M 0 9999999999;\n", "its multiplexers"),
    "below 0": (f"{PAGED}SG_MUL_VAL_ 1280 S M -999999999 -5;\n", "its multiplexers have over"),
    "many ranges": (f"{PAGED}SG_MUL_VAL_ 1280 S M {'0-999,' * 99}0-9;\n", "its multiplexers"),
    "5000 digits": (message("9" * 5000), "cannot be read as DBC"),
    "nothing": (HEAD, "holds no messages"),
}


@each_case("name", DBC)
def test_a_dbc_with_numbers_that_no_frame_has_is_refused(name: str) -> None:
    text, said = DBC[name]
    with pytest.raises(ConfigError) as caught:
        load_dbc(text, "x.dbc")
    assert said in str(caught.value)


@each_case(
    "text",
    [
        message("64", signal_of("0|512")),
        message("8", signal_of("63|1")),
        f"{PAGED}SG_MUL_VAL_ 1280 S M 0-255;\n",
        f'{message("8")}CM_ "BO_ 1 B: 65 X";\nCM_ BO_ 1280 "SG_ S : 0|999";\n',
    ],
)
def test_a_dbc_is_read_up_to_what_a_frame_has(text: str) -> None:
    (found,) = load_dbc(text, "x.dbc").messages
    assert found.length in (8, 64)


OBJECT = "ParameterName=a\nObjectType=8\nCompactSubObj=1\nDataType=7\nAccessType=rw\n"
ENTRY = f"[DeviceInfo]\n[2000]\n{OBJECT}"
EDS = {
    "half a million lines of rubbish": ("[FileInfo]\n" + "x\n" * (MAX_BYTES // 2), "x.eds:2: "),
    "as values of no key": ("[FileInfo]\n" + " x\n" * 9999, "x.eds:2: cannot be read as EDS: "),
    "10^9 lines of comments": ("[Comments]\nLines=1000000000\n", "has no Line1"),
    "10^8 entries": (f"{ENTRY}[2000Name]\nNrOfEntries=100000000\n1=x\n", "has no 2"),
    "a number of 5000 digits": (ENTRY.replace("=8", "=" + "9" * 5000), "cannot be read as EDS"),
    "an entry before its object": (
        "[DeviceInfo]\n[2000sub1]\nParameterName=a\n",
        "contradicts itself",
    ),
    "a text that names another": (ENTRY.replace("=8", "=%(x)s"), "'%(x)s' is no number"),
}


@each_case("name", EDS)
def test_an_eds_with_more_than_it_holds_is_refused(name: str) -> None:
    text, said = EDS[name]
    before_s = time.process_time()
    with pytest.raises(ConfigError) as caught:
        load_eds(text, "x.eds", 3)
    assert said in str(caught.value)
    assert len(str(caught.value)) < 6000
    assert time.process_time() - before_s < 5.0  # the reader alone: minutes for the first one


def test_some_lines_that_go_on_are_left_to_the_reader() -> None:
    said = "".join(f" more {i}\n" for i in range(MOST_ODD_LINES))
    assert load_eds(f"[DeviceInfo]\nDescription=a\n{said}", "x.eds", 3) is not None
