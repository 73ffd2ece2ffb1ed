"""What is too large, endless or no file is refused before a library multiplies it."""

from __future__ import annotations

import gzip
import os
import socket
import struct
import tracemalloc
from pathlib import Path

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from asammdf import MDF

from aff_runtime.base.errors import PlantError
from sim_plant.cli.main import main
from sim_plant.line.reading.load import load_declaration, read_source
from sim_plant.line.record_file import read_columns
from sim_plant.line.yaml_file import load_yaml
from sim_plant.refine.records import limits, mdf_table, parquet_table, text_table
from sim_plant.refine.records.in_child import table_from_child
from sim_plant.refine.records.mdf_table import mdf_table as mdf_columns
from sim_plant.refine.records.parquet_table import parquet_table as parquet_columns
from sim_plant.refine.records.read import read_record
from sim_plant.servers.map_file import load_plc_map
from tests.security.record_files import STAMPS, saved

pytestmark = pytest.mark.processes

READERS = {
    "r.csv": read_record,
    "r.csv.gz": read_record,
    "r.parquet": read_record,
    "r.mf4": read_record,
    "line.yaml": load_declaration,
    "map.yaml": load_plc_map,
    "columns.csv": lambda path: read_columns(path, ["time_s"]),
}


def make(kind, path):
    if kind == "a pipe":
        os.mkfifo(path)
    elif kind == "a folder":
        path.mkdir()
    elif kind == "a device":
        path.symlink_to("/dev/zero")
    else:
        with socket.socket(socket.AF_UNIX) as one:
            one.bind(str(path))


@pytest.mark.parametrize("kind", ["a pipe", "a folder", "a device", "a socket"])
@pytest.mark.parametrize("name", READERS)
def test_what_is_no_file_is_refused_in_words(tmp_path, monkeypatch, name, kind):
    """A pipe that nobody writes would wait for ever."""
    monkeypatch.chdir(tmp_path)  # a socket's name is short
    path = Path(name)
    make(kind, path)
    with pytest.raises(PlantError, match=f"^{name}: is {kind}; give a file"):
        READERS[name](path)


@pytest.mark.parametrize("name", ["/proc/self/mem", "/proc/1/environ/x", "x" * 300, "a\0b"])
def test_a_name_that_cannot_be_read_is_said(tmp_path, name):
    with pytest.raises(PlantError, match="cannot be read"):
        read_record((tmp_path / name).with_suffix(".csv") if name[0] != "/" else f"{name}.csv")


def rows(count, line="0.01,1.0\n"):
    return f"time_s,x_N\n{line * count}".encode()


def peak_bytes(act):
    tracemalloc.start()
    try:
        act()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("read", [read_record, lambda path: read_columns(path, ["time_s"])])
@pytest.mark.sweep(every=2)
def test_a_packed_file_is_not_unpacked_beyond_what_is_taken(tmp_path, monkeypatch, read):
    monkeypatch.setattr(text_table, "UNPACKED_BYTES", 1 << 20)
    monkeypatch.setattr("sim_plant.line.record_file.LONGEST_BYTES", 1 << 20)
    path = tmp_path / "r.csv.gz"
    long = f"0.01,1.{'0' * 1000}\n"  # a short line costs as much under tracemalloc
    path.write_bytes(gzip.compress(rows(12_000, long), compresslevel=1))  # 12 MB

    def refused():
        with pytest.raises(PlantError, match="is larger than 1 MB as plain text"):
            read(path)

    assert peak_bytes(refused) < 6 << 20


def test_a_file_that_is_too_large_is_read_no_further(tmp_path, monkeypatch):
    monkeypatch.setattr("sim_plant.refine.records.read.FILE_BYTES", 1000)
    path = tmp_path / "r.csv"
    path.write_bytes(rows(1000))
    with pytest.raises(PlantError, match="is larger than 0 kB; cut it"):
        read_record(path)


def test_a_square_of_short_lines_is_not_held_before_it_is_read(tmp_path):
    """One number a line under many columns: all of them would have been made room for."""
    path = tmp_path / "r.csv"
    columns = 2000
    path.write_text(",".join(f"c{k}" for k in range(columns)) + "\n" + "1\n" * 20_000)

    def refused():
        with pytest.raises(PlantError, match="line 2: 1 values under 2000 columns"):
            read_record(path)

    assert peak_bytes(refused) < 20 << 20


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (",".join(f"c{k}" for k in range(3000)) + "\n1\n2\n", "has 3000 columns, more than 2000"),
        ("time_s," + "n" * 300 + "\n" + "1,2\n" * 300, "its name has 300 characters, more than"),
        ("x" * (2 << 20), "line 1 is longer than 1048576 characters"),
        ("time_s,x_N\n" + "1," + "2" * 200_000 + "\n", "field larger than field limit"),
        ("time_s,x_N\n" + '1,"' + "2\n" * 200_000, "line 2: a quote is left open"),
        ("time_s,x_N\n0.01,\0\n1,2\n", "read '\\x00'; expected a number"),
        ("time_s,x_N\n" + "0.01,nan\n" * 200, "are missing or not numbers"),
        ("time_s,x_N\n" + "0.01,1e999\n" * 200, "are missing or not numbers"),
        ("time_s,x_N\n" + "0.01,1e300\n" * 200, "200 values are too large for a reading"),
        ("time_s,x [kN]\n" + "0.01,1e308\n" * 200, "200 values are missing or not numbers"),
        ("time_s,x_N\n0.01,1.0\n", "holds one row; a record needs two or more"),
        ("time_s,x_N\n", "holds no rows; a record needs two or more"),
        ("time_s,x_N\n0.01,1.0\n0.02,1.0\n", "has 2 rows, too few to judge; give at least 100"),
        ("time_s,x_angle_rad\n0.01,1.0\n0.02,1.0\n", "has 2 rows, too few to judge"),
        ("time_s\n" + "0.01\n" * 200, "holds no channel beside time_s"),
        ("", "holds no rows"),
    ],
)
def test_a_text_record_of_nothing_or_too_much_is_refused_in_a_sentence(tmp_path, text, said):
    path = tmp_path / "r.csv"
    path.write_text(text)
    with pytest.raises(PlantError) as raised:
        read_record(path)
    assert said in str(raised.value)
    assert len(str(raised.value)) < 500


def test_more_values_than_are_taken_end_the_reading(tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "VALUES", 1000)
    path = tmp_path / "r.csv"
    path.write_bytes(rows(100_000))
    with pytest.raises(PlantError, match="has 1002 values or more, where 1000 are taken"):
        read_record(path)


def test_a_record_of_one_and_a_half_seconds_is_refused_in_a_sentence(tmp_path, capsys):
    path = tmp_path / "r.csv"
    line = load_declaration("config/lines/euclid.yaml")
    names = ["line_speed_ref_m_s", "tension_ref_N", *(s.channel for s in line.sensors)]
    table = [[0.01 * k, 1.0, 89.0, *(0.5 + 0.01 * k for _ in names[2:])] for k in range(150)]
    np.savetxt(path, table, "%.4f", ",", header=",".join(["time_s", *names]), comments="")
    out = str(tmp_path / "out")
    assert main(["refine", "config/lines/euclid.yaml", str(path), "--out", out]) == 2
    said = capsys.readouterr().err
    assert said.startswith(f"sim-plant: {path}: ")
    assert "Traceback" not in said
    assert not (tmp_path / "out").exists()


def parquet(path, **columns):
    pyarrow.parquet.write_table(pyarrow.table(columns), path)
    return path


def test_a_parquet_file_of_many_rows_is_refused_by_its_footer(tmp_path):
    """A column of one value packs 10 000 to 1."""
    path = parquet(tmp_path / "r.parquet", time_s=pyarrow.array(np.zeros(60_000_000, np.int8)))
    assert path.stat().st_size < 1 << 20
    with pytest.raises(PlantError, match="has 60000000 values or more, where 50000000 are taken"):
        read_record(path)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        (["run"] * 200, "holds string"),
        ([[1.0]] * 200, "holds list<"),
        ([{"a": 1}] * 200, "holds struct<"),
        (pyarrow.array([1] * 200, pyarrow.decimal128(5)), "holds decimal128"),
        (pyarrow.array([1] * 200, pyarrow.duration("s")), "holds duration"),
        (pyarrow.array([b"x"] * 200, pyarrow.binary()), "holds binary"),
        (pyarrow.array(["x"] * 200).dictionary_encode(), "holds dictionary<"),
    ],
)
def test_a_parquet_column_of_other_things_is_refused_before_it_is_read(tmp_path, values, said):
    path = parquet(tmp_path / "r.parquet", time_s=0.01 * np.arange(200), x_N=values)
    with pytest.raises(PlantError, match=f"column x_N {said}"):
        parquet_columns(path, path.read_bytes())


def test_a_parquet_file_that_unpacks_to_too_much_is_refused_by_its_footer(tmp_path, monkeypatch):
    monkeypatch.setattr(parquet_table, "UNPACKED_BYTES", 1000)
    path = parquet(tmp_path / "r.parquet", time_s=np.random.default_rng(1).normal(size=4000))
    with pytest.raises(PlantError, match="unpacked, more than 0 kB"):
        parquet_columns(path, path.read_bytes())


def test_an_mdf_file_that_claims_many_rows_is_refused_by_its_headers(tmp_path):
    path = saved(tmp_path / "r.mf4", "4.10")
    payload = bytearray(path.read_bytes())
    at = payload.index(b"##CG")
    cycles = at + 24 + 8 * 6 + 8  # head, six links, record id
    assert struct.unpack_from("<Q", payload, cycles) == (STAMPS.size,)
    struct.pack_into("<Q", payload, cycles, 10**9)
    with pytest.raises(PlantError, match="values or more, where 50000000 are taken"):
        mdf_columns(path, bytes(payload))


def test_an_mdf_file_of_many_channels_is_refused_by_its_headers(tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "COLUMNS", 1)
    path = saved(tmp_path / "r.mf4", "4.10")
    with pytest.raises(PlantError, match="has 2 columns, more than 1"):
        mdf_columns(path, path.read_bytes())


def test_values_that_are_fewer_than_their_stamps_are_refused(tmp_path, monkeypatch):
    class Short:
        name, unit, invalidation_bits = "x_N", "", None
        samples, timestamps = np.ones(1), STAMPS

    path = saved(tmp_path / "r.mf4", "4.10")
    monkeypatch.setattr(MDF, "iter_channels", lambda *_, **__: iter([Short]))
    with pytest.raises(PlantError, match="channel x_N has 1 values for 400 stamps"):
        mdf_columns(path, path.read_bytes())
    assert mdf_table.mdf_table is mdf_columns


def endless(path):
    """Write an MDF file whose data group comes after itself."""
    payload = bytearray(saved(path, "4.10").read_bytes())
    at = payload.index(b"##DG")
    struct.pack_into("<Q", payload, at + 24, at)
    path.write_bytes(payload)
    return bytes(payload)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"cpu_s": 1}, "takes more than 1 s to read and is given up"),
        ({"wall_s": 0.5}, "was not read in 0.5 s and is given up"),
    ],
)
@pytest.mark.sweep(every=2)
def test_a_file_without_end_is_given_up(tmp_path, given, said):
    payload = endless(tmp_path / "r.mf4")
    with pytest.raises(PlantError, match=said):
        table_from_child(tmp_path / "r.mf4", "mdf", payload, **given)


def test_a_file_that_needs_more_memory_than_there_is_to_work_in_is_given_up(tmp_path):
    path = parquet(tmp_path / "r.parquet", time_s=np.zeros(20_000_000))
    room = 400 << 20  # of which the libraries take 290
    with pytest.raises(PlantError, match="400 MB"):
        table_from_child(path, "parquet", path.read_bytes(), memory_bytes=room)


TOP = "schema: web-line-declaration/1\n"
LEVELS = "".join(
    f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 9)}]\n" if k else "a0: &a0 [x]\n" for k in range(10)
)
MERGES = "".join(
    f"m{k}: &m{k}\n  <<: [{', '.join([f'*m{k - 1}'] * 9)}]\n  k{k}: 1\n"
    if k
    else "m0: &m0\n  k0: 1\n"
    for k in range(10)
)


SLOW = (
    (LEVELS, r":\d+:\d+: its aliases unfold to too much; write it out"),
    (MERGES, r":\d+:\d+: its aliases unfold to too much; write it out"),
    ("a: " + "[" * 100_000, r":2:35: is nested deeper than 32 levels"),
    ("a: [" + "1, " * 200_000 + "]", r":2:\d+: holds more than 50000 values"),
)
"""What takes its time to read; the readers have one parser, the first one takes it."""
HOSTILE = (
    ("a: &a [*a]\n", r":2:4: its aliases unfold to too much"),
    ("a: &a\n  <<: *a\n", r":3:3: its aliases unfold to too much"),
    ("a: {" * 40, r":2:\d+: is nested deeper than 32 levels"),
    ("a: " + "9" * 30_000, r":2:4: a value has 30000 characters, more than 20000"),
    ("a: " + "9" * 10_000, r":2:4: a number has 10000 characters, more than 100"),
    ("a: " + "1:" * 9_000 + "1", r":2:4: a number has 18001 characters, more than 100"),
    ("a: 2020-13-45\n", r":2:4: not YAML: a value cannot be read \(month must be"),
    ("a: !!timestamp x\n", r":2:4: not YAML: a value cannot be read"),
    ('a: !!int ""\n', r":2:4: not YAML: a value cannot be read"),
    ("a: !!bool maybe\n", r":2:4: not YAML: a value cannot be read"),
    ("a: !!python/object/apply:os.system ['true']\n", r":2:4: not YAML: could not determine"),
    ("? [1, 2]\n: 3\n", r":2:3: not YAML: found unhashable key"),
    ("a: 1\na: 2\n", r":3:1: a: is given twice, first in line 2; keep one"),
    ("a: \x1b[2J\n", r":2:4: not YAML: "),
    ("a: b: c\n", r":2:5: not YAML: mapping values are not allowed"),
    ("x" * (1 << 20), r": is larger than 1 MB; cut it"),
)
FEW = HOSTILE[:2]
"""What of it each of the other readers takes beside; that they have one parser shows in these."""
YAML_READERS = (load_declaration, load_plc_map, load_yaml, read_source)


@pytest.mark.parametrize(
    ("read", "text", "said"),
    [
        pytest.param(read, text, said, marks=() if is_quick else pytest.mark.long)
        for read in YAML_READERS
        for text, said in ((*SLOW, *HOSTILE) if read is YAML_READERS[0] else HOSTILE)
        for is_quick in [read is YAML_READERS[0] or (text, said) in FEW]
    ],
)
def test_yaml_that_unfolds_or_never_ends_is_refused_at_its_place(tmp_path, read, text, said):
    path = tmp_path / "x.yaml"
    path.write_text(TOP + text)
    with pytest.raises(PlantError, match=f"^{path}{said}"):
        read(path)


def test_yaml_of_other_bytes_is_refused_with_its_line(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_bytes(b"a: 1\nb: \xff\n")
    with pytest.raises(PlantError, match="line 2: byte 0xff is not UTF-8"):
        load_yaml(path)


def test_names_of_a_line_that_do_not_print_are_refused(tmp_path):
    text = Path("config/lines/euclid.yaml").read_text(encoding="utf-8")
    path = tmp_path / "line.yaml"
    path.write_text(text.replace("channel: unwind_tension_N", 'channel: "\\e[2J_N"', 1))
    with pytest.raises(PlantError, match="all of which print") as raised:
        load_declaration(path)
    assert all(line.isprintable() for line in str(raised.value).split("\n"))
