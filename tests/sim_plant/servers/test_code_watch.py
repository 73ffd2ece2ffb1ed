"""A library that does not return ends the plant, with its name and what it was asked."""

from __future__ import annotations

import asyncio
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from aff_runtime.base.errors import PlantError
from sim_plant.servers import code_watch, serve
from sim_plant.servers.code_watch import LOOKS, THREAD, CodeWatch
from sim_plant.servers.plc_code import CodePlc
from sim_plant.servers.serve import PlantService, ServeOptions
from tests.sim_plant.cli.test_serve import ARGUMENTS, PROGRAM
from tests.sim_plant.servers.built_code import built
from tests.sim_plant.servers.fake_line import REPOSITORY, FakeLine, default_map

needs_cc = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler `cc` on PATH")
PATIENCE_S = 60.0
CODE = """
#include "aff_plc.h"

void aff_plc_begin(void) {}

int aff_plc_scan(struct aff_plc_scan *scan)
{
    for (volatile int at = 0; scan->time_s > 0.5;)
        at++;
    return 0;
}
"""
LOOKS_OFTEN = "from sim_plant.servers import code_watch; code_watch.LOOK_S = 0.02"
BEGINS_NOT = CODE.replace("begin(void) {", "begin(void) { for (volatile int at = 0;;) at++; ")


class EndedError(Exception):
    """The process would be over."""


@pytest.fixture
def watch(monkeypatch: pytest.MonkeyPatch) -> CodeWatch:
    def end(code: int) -> None:
        raise EndedError(code)

    monkeypatch.setattr(code_watch, "LOOK_S", 1e6)  # the test alone looks
    monkeypatch.setattr(code_watch.os, "_exit", end)
    return CodeWatch("--plc-code plc.so")


def test_a_call_that_every_look_finds_is_the_last(
    watch: CodeWatch, capsys: pytest.CaptureFixture[str]
) -> None:
    with watch.call("aff_plc_scan"):
        for _ in range(LOOKS - 1):
            watch.look()
        with pytest.raises(EndedError, match=str(PlantError.exit_code)):
            watch.look()
    assert "--plc-code plc.so: aff_plc_scan has not returned for" in capsys.readouterr().err


def test_calls_that_return_are_never_the_last(watch: CodeWatch) -> None:
    for _ in range(2 * LOOKS):
        with watch.call("aff_plc_scan"):
            watch.look()
    for _ in range(LOOKS - 1):
        watch.look()
        with watch.call("aff_plc_scan"):
            pass
    with watch.call("aff_plc_scan"):
        for _ in range(LOOKS - 1):
            watch.look()


@needs_cc
def test_the_watch_is_over_with_its_library(tmp_path: Path) -> None:
    before = set(threading.enumerate())
    plc = CodePlc(default_map(), built(tmp_path, CODE))
    (thread,) = (one for one in set(threading.enumerate()) - before if one.name == THREAD)
    del plc
    thread.join(PATIENCE_S)
    assert not thread.is_alive()


@needs_cc
def test_the_begin_of_a_library_is_watched_too(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    watched, whole = [], CodeWatch.call
    monkeypatch.setattr(
        CodeWatch, "call", lambda self, name: watched.append(name) or whole(self, name)
    )
    CodePlc(default_map(), built(tmp_path, CODE)).restart()
    assert watched == ["aff_plc_begin", "aff_plc_begin"]


@needs_cc
@pytest.mark.wire
@pytest.mark.processes
@pytest.mark.parametrize(
    ("code", "function"),
    [(CODE, "scan"), pytest.param(BEGINS_NOT, "begin", marks=pytest.mark.long)],
)  # quick: the begin is watched, above
def test_a_served_line_ends_by_itself_when_its_code_does_not_return(
    tmp_path: Path, code: str, function: str
) -> None:
    library = str(built(tmp_path, code))
    words = [*ARGUMENTS, "--modbus", "127.0.0.1:0", "--plc-code", library]
    with subprocess.Popen(
        [sys.executable, "-c", f"{LOOKS_OFTEN}{PROGRAM}", *words],
        cwd=REPOSITORY,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            _, err = process.communicate(timeout=PATIENCE_S)
        finally:
            process.kill()
    assert process.returncode == PlantError.exit_code
    assert f"{library}: aff_plc_{function} has not returned" in err


@needs_cc
@pytest.mark.wire
@pytest.mark.parametrize("with_code", [True, False])
def test_real_time_rights_are_not_asked_for_where_code_of_the_user_s_may_keep_the_core(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, with_code: bool
) -> None:
    asked, said = [], []
    monkeypatch.setattr(serve, "ask_for_realtime", lambda: not asked.append(True))
    monkeypatch.setattr(serve, "shorten_garbage_collections", lambda: None)
    library = built(tmp_path, CODE) if with_code else None
    options = ServeOptions(port=0, plc_code=library, duration_s=0.05)

    async def run() -> None:
        await PlantService(FakeLine(), default_map(), options).run(said.append)

    asyncio.run(run())
    assert asked == ([] if with_code else [True])
    assert said[0].endswith("realtime not asked" if with_code else "realtime granted")
