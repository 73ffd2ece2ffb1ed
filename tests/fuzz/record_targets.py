"""Records under any edit: refused in words, or columns of numbers; no formula ever runs."""

from __future__ import annotations

import atexit
import functools
import io
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from aff_runtime.base.errors import PlantError
from sim_plant.refine.records.read import read_record
from tests.fuzz.source import Source

ROWS = 120
STAMPS = 0.01 * np.arange(ROWS)
CELLS = (
    b"",
    b"nan",
    b"1e999",
    b"-0",
    b"\xff",
    b'"',
    b",",
    b"\r\n",
    b"\0",
    b"\x1b[2J",
    b"1_0",
    b" ",
)
HEADERS = (
    b"time_s,x [kN]",
    b"t;x_N",
    b"time_s,time_s",
    b"time [ms],x_angle_rad",
    b"\xef\xbb\xbft,x_N",
)
_FOLDER = tempfile.TemporaryDirectory(prefix="aff-fuzz-")
MARK = Path(_FOLDER.name) / "was run"


def text(data: bytes) -> str:
    """A spoilt CSV file is refused in a sentence that prints, or is a record."""
    source = Source(data)
    lines = [b"%.2f,%d" % (0.01 * k, k % 7) for k in range(ROWS)]
    head = source.pick((b"time_s,unwind_tension_N", *HEADERS))
    for _ in range(source.below(3)):
        at, word = source.below(ROWS), source.pick(CELLS)
        lines[at] = word.join(lines[at].split(b",")) if source.byte() & 1 else word
    if source.byte() & 1:
        del lines[source.below(ROWS) :]
    path = Path(_FOLDER.name) / "r.csv"
    path.write_bytes(source.spoilt(b"\n".join([head, *lines])))
    try:
        found = read_record(path)
    except PlantError as error:
        return "refused" if str(error).isprintable() and str(error) else "refused without a word"
    for name, values in found.columns.items():
        assert name.isprintable()
        assert np.isfinite(values).all()
    assert all(said.isprintable() for said in found.findings)
    return "ok"


def parquet(data: bytes) -> str:
    """A spoilt Parquet file is refused, or columns of numbers."""
    source = Source(data)
    return _READER.became("parquet", _overwritten(source, source.pick(_parquet_seeds())))


def mdf(data: bytes) -> str:
    """A spoilt MDF file, some with a formula in it, is refused, or columns of numbers."""
    source = Source(data)
    return _READER.became("mdf", _overwritten(source, source.pick(_mdf_seeds())))


def conversion(data: bytes) -> str:
    """MDF 4 conversions of any kind that refer to any block: no formula of theirs runs."""
    source = Source(data)
    seed = bytearray(source.pick([s for s in _mdf_seeds() if b"##CC" in s]))
    blocks = [at for at in range(0, len(seed) - 4) if seed[at : at + 2] == b"##"]
    own = [at for at in blocks if seed[at : at + 4] == b"##CC"]
    for _ in range(source.below(4)):
        at, links = source.pick(own), source.below(8)
        place = at + 24 + 8 * links
        if source.byte() & 1:
            seed[place : place + 8] = source.pick(blocks).to_bytes(8, "little")
        else:
            seed[place] = source.below(13)  # the kind of conversion, where so many links end
    return _READER.became("mdf", bytes(seed))


def _overwritten(source: Source, good: bytes) -> bytes:
    """A copy with up to five places overwritten, so that addresses stay, now and then cut."""
    bad = bytearray(good)
    for _ in range(source.below(6)):
        at, size = source.word() % len(bad), 1 + source.below(8)
        kind = source.below(3)
        new = source.take(size) if kind == 0 else (b"\0", b"\xff")[kind - 1] * size
        bad[at : at + len(new)] = new
    return bytes(bad[: source.word()]) if source.byte() % 16 == 15 else bytes(bad)


@functools.cache
def _parquet_seeds() -> tuple[bytes, ...]:
    import pyarrow
    import pyarrow.parquet

    made = []
    for packed in ("snappy", "none"):
        into = io.BytesIO()
        columns = {"time_s": STAMPS, "x_N": STAMPS, "n": np.arange(ROWS)}
        pyarrow.parquet.write_table(pyarrow.table(columns), into, compression=packed)
        made.append(into.getvalue())
    return tuple(made)


@functools.cache
def _mdf_seeds() -> tuple[bytes, ...]:
    from tests.security import record_files as files

    formula = files.touching(MARK)
    tables = files.range_to(files.range_to(b"low", files.algebraic(formula)))
    made = (
        ("4.10", files.put(files.rational(P1=0.0, P2=2.0, P3=1.0, P4=0.0, P5=0.0, P6=1.0))),
        ("3.30", lambda _: None),
        ("4.10", files.put(files.algebraic(formula))),
        ("4.10", files.put(tables)),
        ("4.10", files.put(files.algebraic(formula), files.TIME)),
        ("4.10", files.logged_bus(files.algebraic(formula))),
        ("3.30", files.put(files.formula_3(formula))),
    )
    path = Path(_FOLDER.name)
    return tuple(
        files.saved(path / f"{k}.mf4", version, change).read_bytes()
        for k, (version, change) in enumerate(made)
    )


class _Reader:
    """A process that reads, started when it is needed, and again when an input ended it."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        atexit.register(self.close)

    def became(self, kind: str, payload: bytes) -> str:
        """Return what became of an input; AssertionError with the trace when it broke."""
        process = self._running()
        assert process.stdin is not None
        assert process.stdout is not None
        try:
            process.stdin.write(json.dumps([kind, len(payload)]).encode() + b"\n" + payload)
            process.stdin.flush()
        except BrokenPipeError:
            pass
        answer = process.stdout.readline()
        assert not MARK.exists(), "a formula was run"
        if not answer:
            self.close()
            return "given up"
        word, trace = json.loads(answer)
        assert word != "broken", trace
        return str(word)

    def _running(self) -> subprocess.Popen[bytes]:
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "tests.fuzz.record_reader"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                cwd=Path(__file__).parents[2],
                env={**os.environ, "NUMEXPR_SANITIZE": "0", "TMPDIR": _FOLDER.name},
            )
        return self._process

    def close(self) -> None:
        """End the process; the next input starts another."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None


_READER = _Reader()
SEEDS = [bytes(12), bytes(range(40)), b"\x01\x02\x03" * 12, b"\x05\x04\x09\x01\x07" * 6]
