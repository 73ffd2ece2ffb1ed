"""The tests of the recipe page pass, on real processes and sockets in stepped time.

All of them are long; quick are one test of the plugin and what the page itself shows.
"""

import os
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from sim_plant.pytest_plugin import plugin
from sim_plant.servers.faults import Fault, parse_fault

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

@pytest.fixture(autouse=True)
def injected(monkeypatch):
    from sim_plant.pytest_plugin.web_line import WebLine

    def inject(line, fault, inject=WebLine.inject):
        begin_s = inject(line, fault)
        with open("injected", "a") as names:
            print(fault, file=names)
        return begin_s

    monkeypatch.setattr(WebLine, "inject", inject)
"""
KINDS = """
import pytest

def test_on_udp_a_client_is_answered(web_line_factory):
    line = web_line_factory(udp=True)
    assert not line.client().read_holding_registers(0, count=1).isError()

def test_in_real_time_nothing_is_stepped_and_time_passes(web_line_factory):
    line = web_line_factory(stepped=False)
    begin_s = line.status().time_s
    with pytest.raises(Exception, match="serve --stepped"):
        line.step()
    line.inject("busy")
    assert line.status().time_s > begin_s

def test_a_reference_is_in_force_on_return(web_line):
    web_line.set("tension_ref_N", 75)
    assert web_line.value("tension_ref_N") == 75

def test_a_long_step_is_as_long_as_asked(web_line):
    begin_s = web_line.status().time_s
    assert web_line.step(4500) - begin_s == pytest.approx(4500 * web_line.sample_time_s)

def test_the_line_of_the_factory_is_the_tests_own(web_line, web_line_factory):
    other = web_line_factory()
    other.step(10)
    assert other.status().time_s > web_line.status().time_s
"""
WRONG = """
def test_fault(web_line):
    web_line.inject('melt')

def test_channel(web_line):
    web_line.value('speed')

def test_words(web_line_factory):
    web_line_factory(words=('--fault', 'melt'))
"""
_ONCE = ["-p", "no:web_line", "-p", "sim_plant.pytest_plugin.plugin"]  # installed or not


def _pytest(folder, *words, conftest=CONFTEST):
    (folder / "conftest.py").write_text(conftest)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *_ONCE, *words]
    return subprocess.run(
        command,
        cwd=folder,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=280,
        check=False,
    )


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """The page's tests, run; the folder holds the faults that they injected."""
    folder = tmp_path_factory.mktemp("page")
    (folder / "test_page.py").write_text("\n".join(_BLOCK.findall(PAGE.read_text("utf-8"))))
    return _pytest(folder), folder / "injected"


def test_every_fault_has_a_test_on_the_page():
    text = "\n".join(_BLOCK.findall(PAGE.read_text("utf-8")))
    compile(text, str(PAGE), "exec")
    named = set(re.findall(r"[\"']([a-z]+)\b", text))
    assert {fault.value for fault in Fault} <= named


@pytest.mark.long
def test_every_test_on_the_page_passes_and_none_is_skipped(page):
    done, _ = page
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^\d+ passed in ", done.stdout, re.MULTILINE), done.stdout


@pytest.mark.long
def test_every_test_on_the_page_passes_on_the_line_that_a_stranger_gets(tmp_path):
    """On the model itself; the others of this file stand on one that needs no compiler."""
    (tmp_path / "test_page.py").write_text("\n".join(_BLOCK.findall(PAGE.read_text("utf-8"))))
    done = _pytest(tmp_path, conftest="")
    assert done.returncode == 0, done.stdout + done.stderr
    assert re.search(r"^\d+ passed in ", done.stdout, re.MULTILINE), done.stdout


@pytest.mark.long
def test_every_fault_is_injected_by_a_test_of_the_page(page):
    _, injected = page
    names = {parse_fault(spec).fault for spec in injected.read_text().split()}
    assert names == set(Fault)


@pytest.fixture(scope="module")
def beside(tmp_path_factory):
    """What the page says beside its tests, and what goes wrong, in one run; the folder."""
    folder = tmp_path_factory.mktemp("beside")
    (folder / "test_kinds.py").write_text(KINDS)
    (folder / "test_wrong.py").write_text(WRONG)
    return _pytest(folder, "-rp"), folder


@pytest.mark.long
def test_other_kinds_of_line_do_what_the_page_says_of_them(beside):
    done, _ = beside
    passed = re.findall(r"^PASSED test_kinds.py::(\w+)$", done.stdout, re.MULTILINE)
    assert passed == re.findall(r"^def (test_\w+)", KINDS, re.MULTILINE), done.stdout + done.stderr


@pytest.mark.long
def test_what_goes_wrong_is_told_and_no_process_stays(beside):
    done, folder = beside
    assert "3 failed" in done.stdout
    for said in ("unknown name; known are", "no such channel; there are", "cannot be served"):
        assert said in done.stdout
    assert not _processes_of(folder)


def test_a_declaration_is_looked_for_from_where_pytest_was_called(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    given = SimpleNamespace(web_line=Path("mine.yaml"))
    config = SimpleNamespace(option=given, getoption=lambda _: given.web_line)
    with pytest.raises(pytest.UsageError, match=r"mine\.yaml: no such file"):
        plugin.pytest_configure(config)
    (tmp_path / "mine.yaml").touch()
    plugin.pytest_configure(config)
    assert given.web_line == tmp_path / "mine.yaml"


@pytest.mark.long  # quick: the same refusal, above
def test_a_declaration_that_is_not_there_is_refused_before_any_test(tmp_path):
    done = _pytest(tmp_path, "--web-line", "none.yaml")
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert "none.yaml: no such file" in done.stderr


def test_the_declaration_that_is_named_is_served_whatever_folder_a_test_goes_to(tmp_path):
    text = (ROOT / "config" / "lines" / "euclid.yaml").read_text()
    known = re.search(r"^sample_time_s: *([\d.]+)", text, re.MULTILINE)
    (tmp_path / "mine.yaml").write_text(text.replace(known[0], "sample_time_s: 0.010"))
    (tmp_path / "test_mine.py").write_text(
        "def test_mine(tmp_path, monkeypatch, request):\n"
        "    monkeypatch.chdir(tmp_path)\n"
        "    line = request.getfixturevalue('web_line')\n"
        "    line.step()\n"
        "    assert line.sample_time_s == 0.010\n"
    )
    assert float(known[1]) != 0.010
    done = _pytest(tmp_path, "--web-line", "mine.yaml")
    assert done.returncode == 0, done.stdout + done.stderr


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
