"""From the last tag, or the commit before, to this tree and back, with real installations."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from releasing.commands import ROOT

pytestmark = [pytest.mark.long, pytest.mark.timeout(900)]
MINE = {
    "etc/aff-runtime/site.yaml": "# the technician's own\n",
    "etc/systemd/system/aff-runtime.service.d/plc.conf": "[Service]\nIPAddressAllow=10.0.0.9\n",
    "var/lib/aff-runtime/learned/unwind.shape.json": '{"kept": true}\n',
    "var/lib/aff-runtime/runs/20261124T060000Z_euclid/run.yaml": "line: euclid\n",
    "var/lib/aff-runtime/runs/20261124T060000Z_euclid/ticks.bin": "\x00\x01\x02",
}


def run(*words: str | Path, cwd: Path = ROOT) -> str:
    done = subprocess.run(
        [str(word) for word in words], cwd=cwd, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, f"{' '.join(map(str, words))}\n{done.stdout}{done.stderr}"
    return done.stdout


def sources(revision: str, folder: Path) -> Path:
    """Return the tree of a revision; the empty revision is the tree as it stands."""
    folder.mkdir()
    if revision:
        packed = folder.with_suffix(".tar")
        run("git", "archive", "--output", packed, revision)
        run("tar", "xf", packed, "-C", folder)
        return folder
    names = ("deploy", "config", "aff_runtime", "sim_plant", "aff_hmi", "releasing")
    for name in names:
        shutil.copytree(ROOT / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE", "MANIFEST.in"):
        shutil.copy(ROOT / name, folder / name)
    return folder


def before() -> str:
    """Return the newest tag behind this commit, else the commit before it."""
    if not (ROOT / ".git").exists() or shutil.which("git") is None:
        pytest.skip("no checkout of git: nothing to come from")
    tagged = subprocess.run(
        ["git", "describe", "--tags", "--abbrev=0"],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    return tagged.stdout.strip() or run("git", "rev-parse", "HEAD~1").strip()


def fetched(trees: list[Path], folder: Path) -> Path:
    """Fill a folder with the locked packages of the trees, by their hashes."""
    for tree in trees:
        locks = [tree / "deploy" / "locks" / f"{name}.txt" for name in ("build", "gateway", "can")]
        for lock in locks:
            words = ["--quiet", "--require-hashes", "--only-binary", ":all:", "-d", folder]
            command = [sys.executable, "-m", "pip", "download", *words, "-r", lock]
            done = subprocess.run(
                list(map(str, command)), capture_output=True, text=True, check=False
            )
            if done.returncode:
                pytest.skip(f"the package index cannot be reached: {done.stderr[-200:]}")
    return folder


def seen(prefix: Path) -> Mapping[str, bytes]:
    return {name: (prefix / name).read_bytes() for name in MINE}


def test_settings_shapes_records_and_extras_outlive_an_update_and_the_way_back(
    tmp_path: Path,
) -> None:
    old, new = sources(before(), tmp_path / "old"), sources("", tmp_path / "new")
    wheels = fetched([old, new], tmp_path / "wheels")
    prefix = tmp_path / "gateway"
    program = prefix / "opt/aff-runtime/venv/bin/aff-runtime"
    site = prefix / "etc/aff-runtime/site.yaml"

    def install(tree: Path, *more: str) -> str:
        installer = tree / "deploy" / "install.sh"
        words = ["--python", sys.executable, "--wheels", wheels, "--prefix", prefix, *more]
        run("sh", installer, *words)
        state = prefix / "var/lib/aff-runtime"
        run(program, "check", site, "--state-dir", state, cwd=tmp_path)
        return run(program, "--version", cwd=tmp_path)

    install(old, "--can")
    for name, text in MINE.items():
        (prefix / name).parent.mkdir(parents=True, exist_ok=True)
        known = (prefix / name).read_text() if (prefix / name).exists() else ""
        (prefix / name).write_text(known + text)
    mine = seen(prefix)
    assert install(new).startswith("aff-runtime")
    assert seen(prefix) == mine
    compared = run("sh", new / "deploy/install.sh", "--compare", "--prefix", prefix)
    assert "as installed" in compared
    install(old)
    assert seen(prefix) == mine
    install(new, "--fresh")  # the former release may have written no list
    run(prefix / "opt/aff-runtime/venv/bin/python", "-c", "import can")  # asked for once
    assert seen(prefix) == mine
    assert "as installed" in run("sh", new / "deploy/install.sh", "--compare", "--prefix", prefix)
