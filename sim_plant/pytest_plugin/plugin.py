"""The plugin itself; pytest loads it by its entry point, nothing else imports it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sim_plant.pytest_plugin.host_client import HostClient
from sim_plant.pytest_plugin.web_line import LineSetup, WebLine

MakeWebLine = Callable[..., WebLine]


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add ``--web-line``."""
    parser.getgroup("web line").addoption(
        "--web-line",
        metavar="FILE",
        type=Path,
        help="declaration of the line that web_line serves (default: a shipped one)",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Find the declaration from where pytest was called, or refuse it before any test is run."""
    line = config.getoption("--web-line")
    if line is None:
        return
    if not line.is_file():
        raise pytest.UsageError(f"--web-line {line}: no such file; name a line's declaration")
    config.option.web_line = line.absolute()  # a test may change the folder


@pytest.fixture(scope="session")
def web_line_host(tmp_path_factory: pytest.TempPathFactory) -> Iterator[HostClient]:
    """Give the process that forks the plants of this session."""
    host = HostClient(tmp_path_factory.mktemp("web-line"))
    try:
        yield host
    finally:
        host.close()


@pytest.fixture
def web_line_factory(
    web_line_host: HostClient, request: pytest.FixtureRequest
) -> Iterator[MakeWebLine]:
    """Give what serves a line by the settings of ``LineSetup``; all end with the test."""
    lines: list[WebLine] = []

    def make(**settings: Any) -> WebLine:
        settings.setdefault("line", request.config.getoption("--web-line"))
        lines.append(WebLine(web_line_host, LineSetup(**settings)))
        return lines[-1]

    try:
        yield make
    finally:
        _close_all(lines)


@pytest.fixture
def web_line(web_line_factory: MakeWebLine) -> WebLine:
    """Give a fresh line on Modbus TCP in stepped time."""
    return web_line_factory()


def _close_all(lines: list[WebLine]) -> None:
    """Close every line, and tell the first failure when all are closed."""
    failures: list[Exception] = []
    for line in lines:
        try:
            line.close()
        except Exception as error:
            failures.append(error)
    if failures:
        raise failures[0]
