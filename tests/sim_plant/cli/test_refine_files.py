"""`sim-plant refine` from files: every container says the same, and what is spoilt is refused."""

import gc
import gzip
import json

import numpy as np
import pyarrow
import pyarrow.parquet
import pytest
from asammdf import MDF, Signal

from benchmarks.campaign.line import declaration
from sim_plant.cli.main import main
from sim_plant.effects.catalogue import BY_NAME
from sim_plant.line.declared.declaration import Declaration
from sim_plant.line.open import make_line
from sim_plant.refine.records.read import read_record
from tests import quick_yaml

ROWS = 2000
pytestmark = pytest.mark.timeout(300)


@pytest.fixture(scope="module")
def columns():
    """Return 20 s of a line without an effect, by column, values as a logger would keep them."""
    line = Declaration.model_validate(declaration())
    speed = np.interp(np.arange(ROWS), [0, 900, 1100, ROWS], [0.9, 0.9, 1.3, 1.3])
    tension = np.full(ROWS, 89.0)
    run = make_line(line, seed=4, speed_m_s=0.9, tension_N=89.0)
    run.settle(20.0)
    out = run.simulate(speed, tension)
    table = {
        "time_s": np.round(0.01 * np.arange(ROWS), 4),
        "line_speed_ref_m_s": speed,
        "tension_ref_N": tension,
    }
    return table | {s.channel: out[s.channel] for s in line.sensors}


@pytest.fixture
def line_file(tmp_path):
    path = tmp_path / "line.yaml"
    path.write_text(quick_yaml.safe_dump(declaration(), sort_keys=False))
    return path


def write_csv(columns, path):
    rows = [",".join(map(repr, map(float, row))) for row in zip(*columns.values(), strict=True)]
    text = "\n".join([",".join(columns), *rows]) + "\n"
    data = text.encode()
    path.write_bytes(gzip.compress(data) if path.suffix == ".gz" else data)


def write_parquet(columns, path):
    fields = [pyarrow.field(k, pyarrow.float64()) for k in columns]
    pyarrow.parquet.write_table(
        pyarrow.table(list(columns.values()), pyarrow.schema(fields)), path
    )


def write_mdf(columns, path):
    stamps = columns["time_s"] + 100.0  # a logger that has been on for a while
    stem = {"unwind_tension_N": ("unwind_tension", "N"), "line_speed_m_s": ("line_speed", "m/s")}
    with MDF(version="4.10") as mdf:
        mdf.append(
            [
                Signal(
                    samples=v,
                    timestamps=stamps,
                    name=stem.get(k, (k, ""))[0],
                    unit=stem.get(k, (k, ""))[1],
                )
                for k, v in columns.items()
                if k != "time_s"
            ]
        )
        mdf.save(path, overwrite=True)


WRITERS = {"csv.gz": write_csv, "parquet": write_parquet, "mf4": write_mdf}


EXACT = {"tolerances": {"*": 0.0}}
FEW = [w for name in BY_NAME if name != "bearing_drag" for w in ("--without", name)]
"""Exact numbers and one effect in the library: what is compared is the record's way."""


def refined(line_file, record, out, *more):
    command = ["refine", str(line_file), str(record), "--out", str(out), "--workers", "1", *more]
    return main(command)


@pytest.fixture(scope="module")
def from_csv(columns, tmp_path_factory):
    folder = tmp_path_factory.mktemp("plain")
    (folder / "line.yaml").write_text(quick_yaml.safe_dump(declaration() | EXACT, sort_keys=False))
    write_csv(columns, folder / "r.csv")
    assert refined(folder / "line.yaml", folder / "r.csv", folder / "out", *FEW) == 0
    return json.loads((folder / "out" / "verdict.json").read_text())


@pytest.mark.parametrize("ending", ["csv.gz", "parquet"])
def test_what_keeps_every_number_is_the_plain_file_to_the_bit(columns, tmp_path, ending):
    """All that follows a reading follows from it alone, so the verdicts are one verdict."""
    write_csv(columns, tmp_path / "r.csv")
    WRITERS[ending](columns, tmp_path / f"r.{ending}")
    plain, found = (read_record(tmp_path / f"r.{end}") for end in ("csv", ending))
    assert found.sample_time_s == plain.sample_time_s
    assert found.columns.keys() == plain.columns.keys() == columns.keys() - {"time_s"}
    assert all((found.columns[name] == plain.columns[name]).all() for name in plain.columns)


@pytest.mark.long
def test_a_container_whose_stamps_are_rounded_gives_the_verdict_of_the_plain_file(
    columns, from_csv, line_file, tmp_path
):
    record = tmp_path / "r.mf4"
    write_mdf(columns, record)
    line_file.write_text(quick_yaml.safe_dump(declaration() | EXACT, sort_keys=False))
    assert refined(line_file, record, tmp_path / "out", *FEW) == 0
    found = json.loads((tmp_path / "out" / "verdict.json").read_text())
    assert found.pop("holdout") == str(record)
    # stamps that start at 100 s are subtracted: a rounding of 1e-14 s
    for name, row in found["residual_rms"].items():
        assert row == pytest.approx(from_csv["residual_rms"][name], rel=1e-6)
    assert {k: found[k] for k in ("verdict", "effects", "unknown")} == {
        k: from_csv[k] for k in ("verdict", "effects", "unknown")
    }


def without(name):
    return lambda c: {k: v for k, v in c.items() if k != name}


def with_nan(c):
    values = c["unwind_tension_N"].copy()
    values[700] = np.nan
    return c | {"unwind_tension_N": values}


def with_gap(c):
    keep = np.r_[0:800, 850:ROWS]
    return {k: v[keep] for k, v in c.items()}


def renamed(old, new):
    return lambda c: {new if k == old else k: v for k, v in c.items()}


def at_other_radius(c):
    return c | {"unwind_radius_m": c["unwind_radius_m"] - 0.03}


SPOILT = {
    "a gap": (with_gap, ("1 gaps in time_s", "after line 801", "after row 800")),
    "a missing value": (
        with_nan,
        ("column unwind_tension_N: 1 value is missing", "line 702", "row 701"),
    ),
    "a unit nobody knows": (
        renamed("unwind_tension_N", "unwind_tension [stone]"),
        ("unit 'stone' is unknown",),
    ),
    "a wrong unit": (
        renamed("line_speed_m_s", "line_speed [fpm]"),
        ("column line_speed_m_s: 0.00508 times what the speed reference",),
    ),
    "a wrong unit of force": (
        renamed("rewind_tension_N", "rewind_tension [kN]"),
        ("column rewind_tension_N: 1e+03 times the tension reference",),
    ),
    "a missing channel": (
        without("rewind_speed_rad_s"),
        ("declared channels are missing: rewind_speed_rad_s",),
    ),
    "a missing reference": (without("tension_ref_N"), ("column tension_ref_N is missing",)),
    "another line's file": (
        at_other_radius,
        ("unwind_radius_m starts at 0.15 m", "the line file declares 0.18 m"),
    ),
}


@pytest.mark.parametrize(
    "ending", ["csv", "parquet", pytest.param("mf4", marks=pytest.mark.long)]
)  # quick of MDF4: refine/records/test_read_binary.py
@pytest.mark.parametrize("what", list(SPOILT))
@pytest.mark.sweep(every=7)
def test_a_spoilt_record_is_refused_with_its_place_and_nothing_is_written(
    columns, line_file, tmp_path, capsys, what, ending
):
    spoil, said = SPOILT[what]
    record = tmp_path / f"r.{ending}"
    (WRITERS | {"csv": write_csv})[ending](spoil(columns), record)
    before = sorted(p.name for p in tmp_path.iterdir())
    assert refined(line_file, record, tmp_path / "out") == 2
    error = capsys.readouterr().err
    places = {t for t in said if "line 8" in t or "row 8" in t or "line 7" in t or "row 7" in t}
    assert str(record) in error
    assert all(text in error for text in said if text not in places)
    if places:  # a text file has lines and a header, others have rows
        assert sum(text in error for text in places) == 1
    assert sorted(p.name for p in tmp_path.iterdir()) == before


def test_a_spoilt_held_out_record_stops_everything_too(columns, line_file, tmp_path, capsys):
    write_csv(columns, tmp_path / "good.csv")
    write_csv(with_nan(columns), tmp_path / "bad.csv")
    assert (
        refined(
            line_file,
            tmp_path / "good.csv",
            tmp_path / "out",
            "--holdout",
            str(tmp_path / "bad.csv"),
        )
        == 2
    )
    assert "bad.csv" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("as_holdout", [True, False])
def test_a_record_given_twice_is_refused_under_any_name(
    columns, line_file, tmp_path, capsys, as_holdout
):
    for name in ("a.csv", "copy.csv"):
        write_csv(columns, tmp_path / name)
    first, copy, out = (str(tmp_path / name) for name in ("a.csv", "copy.csv", "out"))
    more = ["--holdout", copy] if as_holdout else [copy]
    assert main(["refine", str(line_file), first, *more, "--out", out]) == 2
    assert "copy.csv: is the same record as" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_line_file_with_other_rollers_is_refused(columns, tmp_path, line_file, capsys):
    other = declaration()
    for part in (other["rollers"], other["spans"]):
        text = quick_yaml.safe_dump(part).replace("R3", "R33")
        part[:] = quick_yaml.safe_load(text)
    write_csv(columns, tmp_path / "r.csv")
    (tmp_path / "r.yaml").write_text(quick_yaml.safe_dump(other, sort_keys=False))
    assert refined(line_file, tmp_path / "r.csv", tmp_path / "out") == 2
    assert "declares other rollers" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


# asammdf's own destructor fails on a file that it could not open
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("ending", ["csv.gz", "parquet", "mf4"])
@pytest.mark.sweep(every=3)
def test_a_broken_file_is_refused(line_file, columns, tmp_path, capsys, ending):
    record = tmp_path / f"r.{ending}"
    WRITERS[ending](columns, record)
    record.write_bytes(record.read_bytes()[:999])
    assert refined(line_file, record, tmp_path / "out") == 2
    gc.collect()
    assert f"{record}: not a readable" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()
