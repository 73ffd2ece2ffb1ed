"""The tests of the recipe page pass, on real processes and sockets in stepped time."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from sim_plant.servers.faults import Fault

pytestmark = [pytest.mark.wire, pytest.mark.processes, pytest.mark.timeout(300)]

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "tester" / "recipes.md"
_BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)
CONFTEST = """
import pytest
from sim_plant.pytest_plugin.host_client import HostClient

@pytest.fixture(scope="session")
def web_line_host(tmp_path_factory):
    host = HostClient(
        tmp_path_factory.mktemp("host"), module="tests.sim_plant.pytest_plugin.small_host"
    )
    yield host
    host.close()
"""


def _pytest(folder, *words):
    (folder / "conftest.py").write_text(CONFTEST)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *words]
    if "sim_plant.pytest_plugin.plugin" not in os.environ.get("PYTEST_PLUGINS", ""):
        command += ["-p", "sim_plant.pytest_plugin.plugin"]
    return subprocess.run(
        command,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )


def test_every_test_on_the_page_passes(tmp_path):
    (tmp_path / "test_page.py").write_text("\n".join(_BLOCK.findall(PAGE.read_text("utf-8"))))
    done = _pytest(tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_page_has_a_recipe_for_every_fault():
    text = PAGE.read_text("utf-8")
    assert [fault.value for fault in Fault if f"`{fault.value}" not in text] == []


def test_what_goes_wrong_is_told_and_no_process_stays(tmp_path):
    (tmp_path / "test_wrong.py").write_text(
        "def test_fault(web_line):\n    web_line.inject('melt')\n"
        "def test_channel(web_line):\n    web_line.value('speed')\n"
        "def test_words(web_line_factory):\n    web_line_factory(words=('--fault', 'melt'))\n"
    )
    done = _pytest(tmp_path)
    assert "3 failed" in done.stdout
    for said in ("unknown name; known are", "no such channel; there are", "cannot be served"):
        assert said in done.stdout
    assert not _processes_of(tmp_path)


def test_a_declaration_that_is_not_there_is_refused_before_any_test(tmp_path):
    done = _pytest(tmp_path, "--web-line", "none.yaml")
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert "none.yaml: no such file" in done.stderr


def _processes_of(folder):
    """Processes that were started with this working folder."""
    found = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            if (process / "cwd").resolve() == folder.resolve():
                found.append(process.name)
        except OSError:
            continue
    return found
