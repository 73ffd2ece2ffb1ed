"""Plant, service, screen and Chromium for the tests of this folder."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.link.runtime_directory import runtime_paths
from sim_plant.demo.wires import free_port
from tests.aff_hmi.browser.cut import Cable
from tests.aff_runtime.app.service_run import ROOT, ServiceRun

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or ""
PATIENCE_S = 120.0  # of a start, on a machine that others use too
OUT = ROOT / "out" / "test-hmi"


class Screen:
    """A screen of a running service, with a cable between it and the browser."""

    def __init__(self, service: ServiceRun, *options: str) -> None:
        self.service = service
        self.port = free_port()
        self.cable = Cable(self.port)
        self.log = service.folder / "screen.log"
        self._command = [
            *(sys.executable, "-m", "aff_hmi.main"),
            *("--door", str(runtime_paths(service.runtime_dir).door)),
            *("--listen", f"127.0.0.1:{self.port}", "--host", f"127.0.0.1:{self.cable.port}"),
            *options,
        ]
        self.process = self._start()

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.cable.port}/"

    def _start(self) -> subprocess.Popen[str]:
        with self.log.open("a") as log:
            process = subprocess.Popen(
                self._command, stdout=subprocess.PIPE, stderr=log, text=True, cwd=ROOT
            )
        assert process.stdout is not None
        assert process.stdout.readline().startswith("look: ")
        return process

    def restart(self) -> None:
        """End it and start another one at the same place."""
        self.end()
        self.process = self._start()

    def end(self) -> None:
        self.process.send_signal(signal.SIGCONT)
        self.process.terminate()
        try:
            self.process.wait(10.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        if self.process.stdout is not None:
            self.process.stdout.close()

    def close(self) -> None:
        self.end()
        self.cable.close()


@pytest.fixture(scope="session")
def chromium() -> Iterator[object]:
    """A Chromium without a network but loopback."""
    playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
    if not CHROMIUM:
        pytest.skip("no Chromium on this machine: apt-get install chromium")
    arguments = ["--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE 127.0.0.1", "--disable-gpu"]
    if os.geteuid() == 0:
        arguments.append("--no-sandbox")  # Chromium's own has none for root
    with playwright.sync_playwright() as running:
        browser = running.chromium.launch(executable_path=CHROMIUM, args=arguments)
        yield browser
        browser.close()


@pytest.fixture(autouse=True)
def _pages_are_closed(request: pytest.FixtureRequest) -> Iterator[None]:
    """Close what a test has opened: a page that is left open draws ten frames a second."""
    browser: Any = None
    if "chromium" in request.fixturenames:
        browser = request.getfixturevalue("chromium")
    before = list(browser.contexts) if browser is not None else []
    yield
    for context in browser.contexts if browser is not None else ():
        if context not in before:
            context.close()


@pytest.fixture(scope="session")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ServiceRun]:
    """A service with a PLC of its own, of which the tests may stop and start both."""
    run = ServiceRun(tmp_path_factory.mktemp("line"), patience_s=PATIENCE_S, cycle_ms=5)
    yield run
    run.close()


@pytest.fixture(scope="session")
def screen(service: ServiceRun) -> Iterator[Screen]:
    """A screen of that service."""
    found = Screen(service)
    yield found
    found.close()


@pytest.fixture(scope="session")
def pictures() -> Path:
    """The folder of the screenshots."""
    OUT.mkdir(parents=True, exist_ok=True)
    return OUT
