"""Compiled code is unpickled and run, so its folder is one that nobody else can write."""

from __future__ import annotations

import logging
import os
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from sim_plant.base.cache_folder import own_cache_folder

STRANGER = 4321
ROOT_ONLY = pytest.mark.skipif(os.getuid() != 0, reason="gives files away")


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def refused(caplog, said):
    """Return whether no folder is taken, and one line says why."""
    caplog.clear()
    with caplog.at_level(logging.WARNING):
        found = own_cache_folder("sim_plant", "0123")
    assert found is None
    assert [
        record.getMessage().count("every start compiles anew") for record in caplog.records
    ] == [1]
    assert said in caplog.text


def test_every_level_is_made_for_its_user_alone_whatever_the_umask(home):
    before = os.umask(0)
    try:
        found = own_cache_folder("sim_plant", "0123")
    finally:
        os.umask(before)
    assert found == home / "sim_plant" / "0123"
    for level in (home, home / "sim_plant", found):
        assert stat.S_IMODE(level.stat().st_mode) == 0o700
    assert own_cache_folder("sim_plant", "0123") == found


@pytest.mark.parametrize("level", ["sim_plant", "sim_plant/0123"])
@pytest.mark.parametrize("mode", [0o770, 0o707, 0o777, 0o1777])
def test_a_level_that_others_may_write_is_not_taken(home, caplog, level, mode):
    (home / level).mkdir(parents=True)
    home.chmod(0o700)
    (home / level).chmod(mode)
    refused(caplog, f"{home / level} can be written by others")


@ROOT_ONLY
@pytest.mark.parametrize("level", ["sim_plant", "sim_plant/0123"])
def test_a_level_of_another_user_is_not_taken(home, caplog, level):
    """He makes it first and writes into it what the next one runs."""
    (home / level).mkdir(parents=True, mode=0o755)
    os.chown(home / level, STRANGER, -1)
    refused(caplog, f"{home / level} belongs to user {STRANGER}")


def test_a_level_of_another_user_is_not_taken_by_this_one_either(home, caplog, monkeypatch):
    own_cache_folder("sim_plant", "0123")
    owner = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: STRANGER)
    refused(caplog, "belongs to user" if owner == 0 else "can be written by others")


@pytest.mark.parametrize("level", ["sim_plant", "sim_plant/0123"])
@pytest.mark.parametrize("there", [True, False])
def test_a_link_is_not_taken_and_nothing_is_made_behind_it(home, caplog, tmp_path, level, there):
    (home / level).parent.mkdir(parents=True, mode=0o700)
    target = tmp_path / "elsewhere"
    if there:
        target.mkdir(mode=0o700)
    (home / level).symlink_to(target)
    refused(caplog, str(home / level))
    assert not target.exists() or not list(target.iterdir())


def test_a_file_in_the_way_is_said(home, caplog):
    home.mkdir(mode=0o700)
    (home / "sim_plant").write_text("mine")
    refused(caplog, str(home / "sim_plant"))
    assert (home / "sim_plant").read_text() == "mine"


@ROOT_ONLY
@pytest.mark.parametrize(("owner", "mode"), [(STRANGER, 0o755), (0, 0o777), (0, 0o770)])
def test_a_users_folder_in_which_others_may_move_things_is_not_taken(home, caplog, owner, mode):
    home.mkdir()
    home.chmod(mode)
    os.chown(home, owner, -1)
    refused(caplog, f"{home} can be written by others")


@ROOT_ONLY
def test_a_shared_sticky_folder_will_do_for_what_is_made_in_it(home):
    home.mkdir()
    home.chmod(0o1777)
    assert own_cache_folder("sim_plant", "0123") is not None


@pytest.mark.parametrize("module", ["sim_plant.base.jit", "benchmarks.campaign.jit"])
@pytest.mark.sweep(every=2)
def test_without_a_folder_code_compiles_and_none_is_written_anywhere(tmp_path, module):
    """No fall back to a folder of all: the two modules that compile, each in its process."""
    taken = tmp_path / "cache"
    taken.mkdir()
    for name in ("sim_plant", "aff-campaign"):
        (taken / name).mkdir()
        (taken / name).chmod(0o777)
    (tmp_path / "tmp").mkdir()
    program = tmp_path / "program.py"
    program.write_text(
        f"from {module} import compiled\n"
        "def twice(x):\n    return 2.0 * x\n"
        "one, two = compiled(twice), compiled(twice)\n"
        "assert one(1.5) == two(1.5) == 3.0\n"
    )
    places = {"XDG_CACHE_HOME": taken, "TMPDIR": tmp_path / "tmp", "HOME": tmp_path}
    done = subprocess.run(
        [sys.executable, str(program)],
        env={
            **os.environ,
            "PYTHONPATH": str(Path(__file__).parents[2]),  # the benchmarks are not installed
            **{name: str(place) for name, place in places.items()},
        },
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert done.stderr.count("every start compiles anew") == 1
    assert [path for path in tmp_path.rglob("*") if path.is_file()] == [program]


def test_no_module_names_a_folder_of_all_for_its_cache():
    root = Path(__file__).parents[2]
    for path in (*root.glob("sim_plant/**/jit.py"), *root.glob("benchmarks/**/jit.py")):
        assert "gettempdir" not in path.read_text("utf-8")
