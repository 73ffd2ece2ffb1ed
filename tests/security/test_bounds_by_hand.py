"""What is started by hand among foreign files: bounds, words, and nothing of the folder."""

from __future__ import annotations

import gc
import resource
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import canopen
import cantools
import pytest

from aff_runtime.app.supervisor.validation import load_parameters
from aff_runtime.base.effort import bounded_effort
from aff_runtime.base.errors import ConfigError, PlantError
from aff_runtime.cli.main import main
from aff_runtime.config.devices import load_device
from aff_runtime.fieldbus.can.dbc import load_dbc
from aff_runtime.telemetry.disk_bound import used_bytes
from aff_runtime.telemetry.header import RunMeta
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.run_folder import RunFolder
from sim_plant.servers.can_dbc_node import load_dbc_map
from sim_plant.servers.canopen_device import Bench, Device, NodeRow
from tests import quick_yaml
from tests.aff_runtime.telemetry.heads import head_of

pytestmark = pytest.mark.processes

ROOT = Path(__file__).parents[2]
CONFIG = ROOT / "config"


# --- time and memory ------------------------------------------------------------------------


def takes_long(*_: object, **__: object) -> None:
    """Work as a reader does: it takes every error for one of the file's."""
    end = time.monotonic() + 4.0
    while time.monotonic() < end:
        try:
            sum(range(1000))
        except Exception as error:
            raise ValueError("swallowed") from error
    raise ValueError("nobody ended it")


def takes_long_where_the_end_is_lost(*_: object) -> None:
    """Work as a reader whose end falls into a garbage collection, where Python drops it."""
    try:
        takes_long()
    except BaseException:
        takes_long()


def takes_long_in_a_collection(*_: object) -> None:
    """Work as a reader whose time is over while a library's callback of the collector runs."""

    def callback(*_: object) -> None:
        end_s = time.monotonic() + 0.2
        while time.monotonic() < end_s:
            pass

    gc.callbacks.append(callback)
    try:
        gc.collect()
    finally:
        gc.callbacks.remove(callback)
    takes_long()


def takes_much(*_: object, **__: object) -> None:
    bytearray(3 << 30)
    raise ValueError("nobody refused it")


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(bounded_effort.__wrapped__.__kwdefaults__, "seconds", 0.1)


@pytest.mark.parametrize(
    ("work", "said"),
    [
        (takes_long, "more than 0.1 s"),
        (takes_long_where_the_end_is_lost, "more than 0.1 s"),
        (takes_long_in_a_collection, "more than 0.1 s"),
        (takes_much, "more than 1024 MB"),
    ],
)
def test_time_and_memory_end_in_words_and_the_limits_are_put_back(
    work: Callable[[], None], said: str
) -> None:
    before = resource.getrlimit(resource.RLIMIT_AS), signal.getsignal(signal.SIGALRM)
    with (
        pytest.raises(PlantError, match=rf"^x.dbc: takes {said} to read. A file"),
        bounded_effort("x.dbc", PlantError, seconds=0.1),
    ):
        work()
    assert (resource.getrlimit(resource.RLIMIT_AS), signal.getsignal(signal.SIGALRM)) == before
    assert signal.getitimer(signal.ITIMER_REAL)[0] == 0.0


@pytest.mark.parametrize("command", ["check", "map", "probe-map"])
@pytest.mark.sweep(every=3)
@pytest.mark.usefixtures("quick")
def test_a_dbc_that_takes_its_reader_long_ends_the_command_in_words(
    command: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Multiplexers within multiplexers took 15 s of a file that is in all bounds."""
    monkeypatch.setattr(cantools.database, "load_string", takes_long)
    load_dbc.cache_clear()  # who has read it before reads it no more
    assert main([command, str(CONFIG / "euclid_can.yaml")]) == 2
    assert "takes more than 0.1 s to read" in capsys.readouterr().err


def of_plant(kind: str, folder: Path, content: bytes) -> None:
    """Have the plant read a DBC or an EDS file."""
    if kind == "dbc":
        rows = quick_yaml.safe_load((CONFIG / "plc" / "can_dbc.yaml").read_text())
        (folder / "map.yaml").write_text(quick_yaml.safe_dump({**rows, "dbc": "x.dbc"}))
        (folder / "x.dbc").write_bytes(content)
        load_dbc_map(folder / "map.yaml")
    else:
        (folder / "x.eds").write_bytes(content)
        Device("line", NodeRow(id=1, eds="x.eds"), folder, Bench())


@pytest.mark.parametrize("kind", ["dbc", "eds"])
def test_the_plants_files_of_the_bus_are_bounded_too(
    kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    shipped = CONFIG / {"dbc": "euclid.dbc", "eds": "euclid_line.eds"}[kind]
    of_plant(kind, tmp_path, shipped.read_bytes())
    with pytest.raises(PlantError, match="is larger than 1 MB"):
        of_plant(kind, tmp_path, shipped.read_bytes() + b"\n" * (1 << 20))
    monkeypatch.setitem(bounded_effort.__wrapped__.__kwdefaults__, "seconds", 0.1)
    monkeypatch.setattr(cantools.database, "load_string", takes_long)
    monkeypatch.setattr(canopen, "import_od", takes_long)
    with pytest.raises(PlantError, match=r"takes more than 0\.1 s to read"):
        of_plant(kind, tmp_path, shipped.read_bytes())


# --- device profiles ------------------------------------------------------------------------

ALIASES = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{new}: &{new} [{', '.join([f'*{old}'] * 9)}]\n"
    for old, new in zip("abcd", "bcde", strict=True)
)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("# \n" * 100_000, "is larger than 256 kB"),
        (ALIASES, "aliases unfold to too much"),
        ("[" * 5000, "nests deeper than 20 levels"),
    ],
    ids=["size", "aliases", "depth"],
)
def test_a_device_profile_is_bounded_as_a_site_file_is(
    text: str, said: str, tmp_path: Path
) -> None:
    profile = tmp_path / "device.yaml"
    profile.write_text(text)
    with pytest.raises(ConfigError, match=said):
        load_device(profile)


@pytest.mark.parametrize("shipped", sorted((CONFIG / "devices").iterdir()), ids=lambda p: p.stem)
def test_every_shipped_profile_is_read_as_yaml_says(shipped: Path) -> None:
    plain = quick_yaml.safe_load(shipped.read_text(encoding="utf-8"))
    found = load_device(shipped).model_dump(mode="json", by_alias=True)
    assert found == plain


# --- no folder for temporary files ----------------------------------------------------------


def test_without_a_temporary_folder_the_check_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object, **__: object) -> None:
        raise FileNotFoundError(2, "No usable temporary directory found in ['/tmp']")

    monkeypatch.setattr(tempfile, "TemporaryFile", none)
    with pytest.raises(ConfigError, match=r"site.yaml:1:1  cannot be checked: No usable temp"):
        load_parameters(Path("site.yaml"))


# --- numba's file of the working folder -----------------------------------------------------


@pytest.mark.parametrize("line", ["num_threads: 0", "cache_locator_classes: this.x"])
@pytest.mark.sweep(every=2)
def test_a_numba_configuration_of_the_working_folder_is_not_read(
    line: str, tmp_path: Path
) -> None:
    """One had a module of its choice imported; importing ``this`` prints a poem."""
    (tmp_path / ".numba_config.yaml").write_text(f"{line}\n")
    program = (
        "import numpy, os; from sim_plant.base.jit import compiled\n"
        "from sim_plant.geometry.lookup import *\n"
        "import numba; f = numba.njit(lambda x: x + 1)\n"
        "print(f(1), len(f.signatures), os.getcwd())"
    )
    done = subprocess.run(
        [sys.executable, "-P", "-c", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=100,
        check=False,
    )
    assert done.stdout == f"2 1 {tmp_path}\n", done.stderr


# --- a run folder that began on a full disk -------------------------------------------------


def test_a_run_that_began_on_a_full_disk_is_marked_later_and_can_be_cleared(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    header = replace(head_of(RunMeta(), "2026-01-01T00:00:00Z"), columns=("time_s", "state"))

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as disk:
        disk.setattr(Path, "open", full)
        folder = RunFolder(tmp_path, header, RunContext(name="x", site_text="a: 1\n", segment_s=1))
    assert used_bytes(tmp_path) == 0
    folder.add([(0.0, 0.0)])
    folder.finish(ring_overruns=0)
    assert (folder.path / "site.yaml").read_text() == "a: 1\n"
    assert quick_yaml.safe_load((folder.path / "run.yaml").read_text())["columns"] == list(
        header.columns
    )
    assert used_bytes(tmp_path) > 0
    assert folder.files_lost == 3
