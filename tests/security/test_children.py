"""No process that we start takes modules from the folder it is started in, or talks to systemd."""

from __future__ import annotations

import ast
import contextlib
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import cast

import pytest

from aff_runtime.app.link.parameter_record import ParameterRecord
from aff_runtime.app.supervisor import recorder_child
from aff_runtime.app.supervisor.control_child import ControlChild
from aff_runtime.app.supervisor.recorder_child import RecorderChild
from aff_runtime.app.supervisor.validation import Validation
from aff_runtime.base.python_child import module_command
from aff_runtime.config.yaml_marks import MAX_BYTES
from aff_runtime.telemetry.recorder_messages import RunContext
from aff_runtime.telemetry.ring import RingReader
from sim_plant.base.worker_context import spawn_context
from tests.house.trees import tree_of
from tests.processes import until

pytestmark = pytest.mark.processes

ROOT = Path(__file__).parents[2]
SITE = ROOT / "config" / "euclid.yaml"
COMMAND = Path(sys.executable).with_name("aff-runtime")
FILES = [
    path
    for package in ("aff_runtime", "sim_plant", "benchmarks")
    for path in sorted((ROOT / package).rglob("*.py"))
]
# The two files that every start of a Python process goes through.
BY_MODULE = ROOT / "aff_runtime" / "base" / "python_child.py"
BY_POOL = ROOT / "sim_plant" / "base" / "worker_context.py"
STARTERS = re.compile(r"(exec|spawn|posix_spawn|popen|system$|create_subprocess)")
FORKED = "get_context('fork')"  # starts no Python anew
STARTS = re.compile(
    r"executable|multiprocessing|get_context|ProcessPoolExecutor|python[0-9.]*[\"']"
    r"|\b(os|asyncio)\.(exec|spawn|posix_spawn|popen|system|create_subprocess)"
)
"""What a file that `forbidden` finds something in has in its text: others are not walked."""
PYTHON = re.compile(r"(.*/)?python[0-9.]*")
# What a child of ours imports, by packages of ours or by Python itself; "pickle" for a worker.
HOSTILE = (
    *("annotated_types", "yaml", "numpy", "pydantic", "pymodbus", "json", "pickle", "argparse"),
    *("multiprocessing", "runpy", "tempfile", "aff_runtime", "sim_plant"),
)

HARMLESS = ("get_context", "connection", "Connection")
"""Names of multiprocessing that start nothing by themselves."""


def forbidden(source: ast.Module) -> Iterator[str]:
    """Yield what a source does to start a Python process in a way of its own."""
    for node in ast.walk(source):
        match node:
            case ast.Attribute(value=ast.Name(id="sys"), attr="executable"):
                yield "sys.executable"
            case ast.ImportFrom(module="sys", names=names) if any(
                alias.name == "executable" for alias in names
            ):
                yield "sys.executable"
            case ast.Attribute(value=ast.Name(id="os" | "asyncio" as of), attr=name) if (
                STARTERS.match(name)
            ):
                yield f"{of}.{name}"
            case ast.Attribute(value=ast.Name(id="multiprocessing"), attr=name) if name in (
                "Process",
                "Pool",
                "Manager",
                "set_start_method",
            ):
                yield f"multiprocessing.{name}"
            case ast.ImportFrom(module=str(module), names=names) if module.startswith(
                "multiprocessing"
            ) and any(
                alias.name not in ("get_context", "connection", "Connection") for alias in names
            ):
                yield module
            case ast.Call(func=ast.Name(id="get_context") | ast.Attribute(attr="get_context")) if (
                not ast.unparse(node).endswith(FORKED)
            ):
                yield "get_context"
            case ast.Call(func=ast.Name(id="ProcessPoolExecutor")) if not _is_safe_pool(node):
                yield "ProcessPoolExecutor"
            case ast.List(elts=[ast.Constant(value=str(word)), *_]) if PYTHON.fullmatch(word):
                yield word


def _is_safe_pool(call: ast.Call) -> bool:
    given = [*call.args, *(keyword.value for keyword in call.keywords)]
    texts = [ast.unparse(value) for value in given]
    return any(text == "spawn_context()" or text.endswith(FORKED) for text in texts)


@pytest.mark.parametrize(
    "source",
    [
        "subprocess.Popen([sys.executable, '-m', 'x'])",
        "from sys import executable",
        "os.execv('x', [])",
        "os.system('x')",
        "os.posix_spawn('x', [], {})",
        "multiprocessing.get_context('spawn')",
        "get_context('forkserver')",
        "from multiprocessing import Process",
        "ProcessPoolExecutor(2)",
        "ProcessPoolExecutor(2, mp_context=context)",
        "subprocess.run(['/usr/bin/python3', '-m', 'x'])",
        "asyncio.create_subprocess_exec('x')",
    ],
)
def test_the_walk_sees_every_way_to_start_a_process(source: str) -> None:
    assert list(forbidden(ast.parse(source)))
    assert STARTS.search(source)


def test_the_walk_passes_what_goes_through_the_two_files() -> None:
    fine = "run([*module_command('x')]); ProcessPoolExecutor(2, spawn_context(), f)"
    assert not list(forbidden(ast.parse(fine)))
    assert len(FILES) > 400


def test_every_python_process_is_started_by_the_two_files() -> None:
    others = [
        path
        for path in FILES
        if path not in (BY_MODULE, BY_POOL) and STARTS.search(path.read_text(encoding="utf-8"))
    ]
    found = {str(path): list(forbidden(tree_of(path))) for path in others}
    assert not {path: ways for path, ways in found.items() if ways}


def test_the_command_leaves_the_working_folder_out() -> None:
    assert module_command("x") == [sys.executable, "-P", "-m", "x"]


@pytest.fixture
def trap(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working folder with a module of every name that our processes import; each leaves a file.

    A file in `ran` means that code of the folder was run.
    """
    folder = tmp_path / "from_a_supplier"
    (folder / "ran").mkdir(parents=True)
    for name in HOSTILE:
        text = f"open({str(folder / 'ran' / name)!r}, 'w').close()\nraise SystemExit(66)\n"
        (folder / f"{name}.py").write_text(text)
    monkeypatch.chdir(folder)
    monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
    return folder


def ran(trap: Path) -> list[str]:
    return sorted(path.name for path in (trap / "ran").iterdir())


def test_the_trap_works_where_the_folder_is_on_the_path(trap: Path) -> None:
    subprocess.run([sys.executable, "-m", "aff_runtime.cli.main", "--version"], check=False)
    assert ran(trap)


@contextlib.contextmanager
def both(parameters: ParameterRecord, runs: Path) -> Iterator[tuple[ControlChild, RecorderChild]]:
    """Have a control process and its recorder at work."""
    control = ControlChild(parameters, shadow=True)
    try:
        until("the control process has made a ring", lambda: bool(control.replies()))
        reader = control.open_ring()
        assert reader is not None
        recorder = RecorderChild(reader, runs, RunContext(name="line"))
        yield control, recorder
    finally:
        control.stop(patience_s=5.0)
        control.close()
    recorder.wait(5.0)
    reader.close()


@pytest.mark.skipif(not COMMAND.exists(), reason="the command is not installed beside python")
def test_the_command_itself_runs_nothing_of_the_folder(trap: Path) -> None:
    done = subprocess.run(
        [COMMAND, "check", str(SITE)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert ran(trap) == []


def _double(number: int) -> int:
    return 2 * number


def test_the_workers_of_a_pool_run_nothing_of_the_folder(trap: Path) -> None:
    with ProcessPoolExecutor(1, spawn_context()) as pool:
        assert list(pool.map(_double, range(4))) == [0, 2, 4, 6]
    assert ran(trap) == []
    assert "PYTHONSAFEPATH" not in os.environ


def environment(pid: int) -> dict[str, str]:
    """Return what a process was started with; there is nothing to read until its program runs."""
    place = Path(f"/proc/{pid}/environ")
    until("the process runs its program", lambda: bool(place.read_bytes()))
    rows = place.read_bytes().decode().split("\0")
    return dict(row.split("=", 1) for row in rows if row)


def test_check_control_process_and_recorder_run_nothing_of_the_folder_and_one_speaks_to_systemd(
    trap: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    told = {"NOTIFY_SOCKET": "/run/none", "WATCHDOG_PID": "1", "WATCHDOG_USEC": "500000"}
    for name, text in told.items():
        monkeypatch.setenv(name, text)
    check = Validation(SITE)
    seen = environment(check.pid)
    assert not told.keys() & seen.keys()
    assert seen["PATH"] == os.environ["PATH"]
    result = check.result(wait_s=60.0)
    assert result is not None
    assert result.parameters is not None
    with both(result.parameters, trap / "runs") as (control, recorder):
        assert environment(control.pid)["NOTIFY_SOCKET"] == "/run/none"
        assert not told.keys() & environment(recorder.pid).keys()
        # at real-time priority it would wait for a second thread that has none
        assert len(os.listdir(f"/proc/{control.pid}/task")) == 1
        until("the recorder has made a run", lambda: bool([*trap.glob("runs/*/run.yaml")]))
    assert ran(trap) == []


@pytest.mark.parametrize("step", ["venv", "pip"])
@pytest.mark.sweep(every=2)
def test_the_installer_runs_nothing_of_the_folder(tmp_path: Path, step: str) -> None:
    folder, prefix, mark = tmp_path / "here", tmp_path / "there", tmp_path / "mark"
    folder.mkdir()
    for name in ("venv.py", "pip.py"):
        (folder / name).write_text(f"open({str(mark)!r}, 'w').close()\n")
    stand_in = prefix / "opt/aff-runtime/venv/bin/python" if step == "pip" else tmp_path / "python"
    stand_in.parent.mkdir(parents=True, exist_ok=True)
    stand_in.write_text(
        f"""#!/bin/sh
case "$1 $2" in
    "-m venv" | "-m pip") exec {sys.executable} -m "$2" --help ;;
    *) exec {sys.executable} "$@" ;;
esac
"""
    )
    stand_in.chmod(0o755)
    install = Path(__file__).parents[2] / "deploy" / "install.sh"
    done = subprocess.run(
        ["sh", str(install), "--unlocked", "--prefix", str(prefix), "--python", str(stand_in)],
        cwd=folder,
        capture_output=True,
        text=True,
        check=False,
    )
    assert f"-m {step} " in done.stdout
    assert "usage" in done.stdout.lower()  # it was the real one
    assert not mark.exists()


def test_the_supervisor_does_not_wait_for_a_recorder_that_does_not_listen(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    over = tmp_path / "over"
    script = f"import time; time.sleep(10); open({str(over)!r}, 'w').close()"
    deaf = [sys.executable, "-c", script]
    monkeypatch.setattr(recorder_child, "module_command", lambda _: deaf)
    with (tmp_path / "ring").open("wb") as ring:
        text = "\u00e4" * (MAX_BYTES // 2)
        child = RecorderChild(cast(RingReader, ring), tmp_path, RunContext(site_text=text))
    assert not over.exists()
    child.wait(0.0)
