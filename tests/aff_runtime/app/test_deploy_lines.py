"""Several lines on one gateway, and what an update does with what is installed."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from aff_runtime.cli.main import build_parser
from aff_runtime.config.loader import read_site

ROOT = Path(__file__).parents[3]
DEPLOY = ROOT / "deploy"
needs_analyze = pytest.mark.skipif(
    shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed"
)


def install(prefix: Path, *options: str) -> subprocess.CompletedProcess[str]:
    command = ["sh", str(DEPLOY / "install.sh"), "--python", sys.executable, *options]
    return subprocess.run(
        [*command, "--prefix", str(prefix)], capture_output=True, text=True, check=False
    )


def test_a_line_of_several_has_the_unit_of_the_only_one_and_folders_of_its_own() -> None:
    one = (DEPLOY / "aff-runtime.service").read_text()
    several = (DEPLOY / "aff-runtime@.service").read_text()
    for of_one, of_several in (
        ("Description=AFF Runtime: adaptive feed-forward beside the drives of a web line", None),
        ("/etc/aff-runtime/site.yaml", "/etc/aff-runtime/lines/%i/site.yaml"),
        ("--runtime-dir /run/aff-runtime ", "--runtime-dir /run/aff-runtime-%i "),
        ("/var/lib/aff-runtime/runs", "/var/lib/aff-runtime/lines/%i/runs"),
        ("RuntimeDirectory=aff-runtime\n", "RuntimeDirectory=aff-runtime-%i\n"),
        ("StateDirectory=aff-runtime\n", "StateDirectory=aff-runtime/lines/%i\n"),
        ("ConfigurationDirectory=aff-runtime\n", "ConfigurationDirectory=aff-runtime/lines/%i\n"),
        ("in aff-runtime.service.d/plc.conf", "in aff-runtime@NAME.service.d/plc.conf"),
    ):
        assert one.count(of_one) == 1, of_one
        other = of_several or of_one.replace("a web line", "line %i")
        assert several.count(other) == 1, other
        one = one.replace(of_one, other)
    assert several.partition("[Unit]")[2] == one.partition("[Unit]")[2]


def test_a_line_of_several_has_numbers_of_its_own_from_the_service_it_names() -> None:
    folder = DEPLOY / "observability"
    told = {}
    for unit in ("aff-metrics.service", "aff-metrics@.service"):
        (row,) = re.findall(r"^ExecStart=(.*)$", (folder / unit).read_text(), re.MULTILINE)
        program, *words = row.replace("%i", "film1").split()
        assert program == "/opt/aff-runtime/venv/bin/aff-runtime"
        told[unit] = build_parser().parse_args(words)
    alone, several = told.values()
    assert (alone.line, several.line) == ("", "film1")
    assert str(several.runtime_dir) == f"{alone.runtime_dir}-film1"
    assert several.out == alone.out.with_name("film1.aff.prom")
    for name in ("service", "timer"):
        one, other = (folder / f"aff-metrics{at}.{name}" for at in ("", "@"))
        kept = [row for row in one.read_text().splitlines() if "=" in row and "aff-" not in row]
        theirs = other.read_text().replace(", line %i,", "").splitlines()
        assert [row for row in kept if row not in theirs] == []


@needs_analyze
@pytest.mark.parametrize("words", [["verify"], ["security", "--offline=true", "--threshold=20"]])
def test_systemd_accepts_a_line_of_several_and_it_is_exposed_no_more(
    words: list[str], tmp_path: Path
) -> None:
    text = (DEPLOY / "aff-runtime@.service").read_text()
    unit = tmp_path / "aff-runtime@film1.service"
    unit.write_text(re.sub(r"/opt/\S*/bin/aff-runtime", sys.executable, text))
    done = subprocess.run(
        ["systemd-analyze", *words, str(unit)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout[-300:] + done.stderr
    assert words != ["verify"] or (done.stdout, done.stderr) == ("", "")


def test_the_installer_gives_each_line_a_site_folders_and_its_own_words(tmp_path: Path) -> None:
    done = install(tmp_path, "--dry-run", "--line", "film1", "--line", "film-2")
    assert done.returncode == 0, done.stderr
    for line in ("film1", "film-2"):
        for said in (
            f"{tmp_path}/etc/aff-runtime/lines/{line}/site.yaml",
            f"{tmp_path}/var/lib/aff-runtime/lines/{line}/runs",
            f"aff-runtime@{line}.service.d/plc.conf",
            f"systemctl enable --now aff-runtime@{line}",
            f"status --runtime-dir /run/aff-runtime-{line}",
        ):
            assert said in done.stdout, said
    assert "aff-runtime@.service" in done.stdout
    assert "aff-runtime@" not in install(tmp_path, "--dry-run").stdout


@pytest.mark.parametrize("name", ["", "-x", "a/b", "..", "a b", "film%i", "$(id)"])
def test_a_line_whose_name_is_no_name_of_a_folder_is_refused(name: str, tmp_path: Path) -> None:
    done = install(tmp_path, "--dry-run", "--line", name)
    assert done.returncode == 2
    assert "letters, digits" in done.stderr


@pytest.fixture
def installed(tmp_path: Path) -> Path:
    """Return a prefix with an environment that needs no network: a script, a link, a list."""
    opt = tmp_path / "opt" / "aff-runtime"
    package = opt / "venv" / "lib" / "package"
    (package / "__pycache__").mkdir(parents=True)
    (package / "module.py").write_text("value = 1\n")
    (package / "spaced name.py").write_text("value = 2\n")
    (package / "__pycache__" / "module.pyc").write_bytes(b"cache")
    (opt / "venv" / "bin").mkdir()
    (opt / "venv" / "bin" / "python").symlink_to(sys.executable)
    script = f'. {DEPLOY}/environments.sh; listed "$1/venv" > "$1/installed.sha256"'
    subprocess.run(["sh", "-c", script, "sh", str(opt)], check=True)
    return tmp_path


def test_an_environment_as_it_was_installed_is_said_to_be_so(installed: Path) -> None:
    done = install(installed, "--compare")
    assert done.returncode == 0, done.stdout
    assert done.stdout.endswith("as installed, 3 files\n")
    cache = installed / "opt/aff-runtime/venv/lib/package/__pycache__/module.pyc"
    cache.write_bytes(b"made anew by Python")
    assert install(installed, "--compare").returncode == 0


def _a_changed_file(venv: Path) -> str:
    (venv / "lib/package/module.py").write_text("value = 3\n")
    return "./lib/package/module.py"


def _a_file_more(venv: Path) -> str:
    (venv / "lib/package/evil.pth").write_text("import os\n")
    return "./lib/package/evil.pth"


def _a_file_less(venv: Path) -> str:
    (venv / "lib/package/spaced name.py").unlink()
    return "./lib/package/spaced name.py"


def _another_interpreter(venv: Path) -> str:
    (venv / "bin/python").unlink()
    (venv / "bin/python").symlink_to("/tmp/python")
    return "./bin/python /tmp/python"


@pytest.mark.parametrize(
    "change", [_a_changed_file, _a_file_more, _a_file_less, _another_interpreter]
)
def test_what_is_not_as_installed_is_named(change, installed: Path) -> None:
    name = change(installed / "opt/aff-runtime/venv")
    done = install(installed, "--compare")
    assert done.returncode == 1
    assert name in done.stdout


def test_no_update_builds_on_what_is_not_as_installed(installed: Path) -> None:
    name = _a_changed_file(installed / "opt/aff-runtime/venv")
    before = sorted(path for path in installed.rglob("*"))
    update = install(installed)
    assert update.returncode == 1
    assert name in update.stderr
    assert "--fresh" in update.stderr
    assert sorted(path for path in installed.rglob("*")) == before  # nothing was begun
    assert install(installed, "--dry-run", "--fresh").returncode == 0


def test_what_was_installed_without_a_list_is_said_to_have_none(installed: Path) -> None:
    (installed / "opt/aff-runtime/installed.sha256").unlink()
    done = install(installed, "--compare")
    assert done.returncode == 1
    assert "no list of what was installed" in done.stdout
    assert install(installed, "--dry-run").returncode == 0


def test_a_new_environment_that_fails_leaves_the_one_that_worked(installed: Path) -> None:
    venv = installed / "opt/aff-runtime/venv"
    before = sorted(path.relative_to(venv) for path in venv.rglob("*"))
    nowhere = installed / "no wheels"
    nowhere.mkdir()
    python = installed / "python"  # makes environments without pip: seconds less, and no install
    python.write_text(
        f'#!/bin/sh\n[ "$2" = venv ] && set -- "$@" --without-pip\nexec {sys.executable} "$@"\n'
    )
    python.chmod(0o755)
    options = ("--fresh", "--wheels", str(nowhere), "--python", str(python))
    done = install(installed, *options)
    assert done.returncode != 0
    assert "apt-get install python3-venv" in done.stderr
    assert "the former environment is back" in done.stderr
    assert sorted(path.relative_to(venv) for path in venv.rglob("*")) == before
    assert not venv.with_name("venv.before").exists()


def test_a_site_of_one_of_several_lines_may_name_what_it_learned(tmp_path: Path) -> None:
    done = install(tmp_path, "--dry-run", "--line", "film1")
    (link,) = re.findall(r"\+ ln -s (\S+) (\S+/lines/film1/learned)", done.stdout)
    folder = tmp_path / "etc/aff-runtime/lines/film1"
    state = tmp_path / "var/lib/aff-runtime/lines/film1/learned"
    folder.mkdir(parents=True)
    state.mkdir(parents=True)
    (folder / "learned").symlink_to(link[0])
    assert os.path.samefile(folder / "learned", state)
    shutil.copy(ROOT / "config" / "euclid.yaml", folder / "site.yaml")
    assert read_site(folder / "site.yaml", tmp_path / "var/lib/aff-runtime").site.line


def test_what_a_wheel_is_made_of_is_in_the_copy_that_it_is_made_from(tmp_path: Path) -> None:
    """All folders beside setup.py that it reads: without one of them no wheel is built."""
    read = re.findall(r'parent((?: / "\w+")+)', (ROOT / "setup.py").read_text())
    folders = {"/".join(re.findall(r"\w+", each)) for each in read}
    assert {"config", "deploy/plc"} <= folders
    said = install(tmp_path, "--dry-run").stdout
    assert all(f"{ROOT / folder} " in said for folder in folders), said
