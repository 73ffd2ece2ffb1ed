"""Where a service may be found, by whom, and what a command makes of an answer."""

from __future__ import annotations

import os
import socket
import stat
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from aff_runtime.app.link import request_client, runtime_directory
from aff_runtime.app.link.request_client import ServiceClient
from aff_runtime.app.link.runtime_directory import (
    check_trusted,
    default_directory,
    make_private,
    runtime_paths,
)
from aff_runtime.app.report.status_answer import StatusAnswer, read_answer
from aff_runtime.base.errors import AffError, RefusedError
from aff_runtime.cli import operate
from aff_runtime.cli.main import main
from tests.doubles.virtual_clock import VirtualClock
from tests.each_case import each_case
from tests.security.desk import answering

NOBODY = 65534
as_root = pytest.mark.skipif(os.geteuid() != 0, reason="needs root to act as another user")


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


# --- the folder a service takes -------------------------------------------------------------


def test_a_folder_that_is_not_there_is_made_private_whatever_the_umask(tmp_path: Path) -> None:
    before = os.umask(0)
    try:
        make_private(tmp_path / "a" / "b")
    finally:
        os.umask(before)
    assert mode(tmp_path / "a" / "b") == 0o700


def test_our_own_private_folder_is_taken_as_it_is_with_what_is_in_it(tmp_path: Path) -> None:
    tmp_path.chmod(0o700)
    (tmp_path / "notes").write_text("")
    make_private(tmp_path)
    assert mode(tmp_path) == 0o700


SHARED = {
    "a shared temporary folder": (0o1777, ["somebody-elses"], "lets others write"),
    "a shared temporary folder, empty": (0o1777, [], "lets others write"),
    "a group's folder": (0o770, [], "lets others write"),
    "a home": (0o755, [".profile"], "opens it to others and it holds '.profile'"),
    "a home the group reads": (0o750, ["x\n"], r"opens it to others and it holds 'x\\n'"),
}


@pytest.mark.parametrize(("bits", "files", "why"), SHARED.values(), ids=SHARED.keys())
def test_a_shared_folder_is_refused_in_words_and_stays_open(
    tmp_path: Path, bits: int, files: list[str], why: str
) -> None:
    folder = tmp_path / "shared"
    folder.mkdir()
    for name in files:
        (folder / name).write_text("")
    folder.chmod(bits)
    with pytest.raises(RefusedError, match=rf"mode {bits:04o} .*{why}.*--runtime-dir"):
        make_private(folder)
    assert mode(folder) == bits
    assert sorted(os.listdir(folder)) == files


def test_an_empty_readable_folder_of_ours_is_taken_twice_and_keeps_its_mode(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "rt"
    folder.mkdir()
    folder.chmod(0o755)
    for _ in range(2):
        make_private(folder)
        (folder / "control.lock").write_text("")  # what a run before left
    assert mode(folder) == 0o755


@pytest.mark.parametrize("kind", ["link", "dangling", "file"])
def test_what_is_no_folder_is_refused(tmp_path: Path, kind: str) -> None:
    place = tmp_path / "rt"
    if kind == "file":
        place.write_text("")
    else:
        place.symlink_to(tmp_path if kind == "link" else tmp_path / "none")
    with pytest.raises(RefusedError, match="is not a directory of user"):
        make_private(place)
    with pytest.raises(RefusedError, match="is not a directory"):
        check_trusted(place)


@as_root
def test_a_folder_of_another_user_is_refused(tmp_path: Path) -> None:
    os.chown(tmp_path, NOBODY, NOBODY)
    with pytest.raises(RefusedError, match="is not a directory of user"):
        make_private(tmp_path)


def test_a_folder_that_cannot_be_made_is_refused_in_words(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RefusedError, match=r"File exists.*--runtime-dir"):
        make_private(tmp_path / "file" / "rt")


def test_nothing_of_a_service_has_a_name_in_the_shared_memory_of_all(tmp_path: Path) -> None:
    paths = runtime_paths(tmp_path)
    names = [getattr(paths, name) for name in paths.__dataclass_fields__]
    assert all(path.is_relative_to(tmp_path) for path in names)


# --- the folder a command goes to -----------------------------------------------------------


@pytest.fixture
def machine(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Path]:
    """Pretend that the service is, or is not, installed here."""

    def pretend(*, user: bool, folder: bool) -> Path:
        place = tmp_path / "run-aff-runtime"
        if folder:
            place.mkdir()
        monkeypatch.setattr(runtime_directory, "INSTALLED", place)
        name = "root" if user else "no-such-user"
        monkeypatch.setattr(runtime_directory, "SERVICE_USER", name)
        return place

    return pretend


@pytest.mark.parametrize(("user", "folder"), [(True, False), (False, True), (True, True)])
def test_where_the_service_is_installed_no_command_falls_through_to_another_place(
    machine: Callable[..., Path], tmp_path: Path, user: bool, folder: bool
) -> None:
    place = machine(user=user, folder=folder)
    for environment in ({}, {"XDG_RUNTIME_DIR": str(tmp_path)}):
        assert default_directory(environment) == place
    assert default_directory({"RUNTIME_DIRECTORY": "/run/x:/run/y"}) == Path("/run/x")


def test_elsewhere_it_is_the_own_session_or_the_own_name_in_tmp(
    machine: Callable[..., Path], tmp_path: Path
) -> None:
    machine(user=False, folder=False)
    own = Path(f"/tmp/aff-runtime-{os.geteuid()}")
    assert default_directory({"XDG_RUNTIME_DIR": str(tmp_path)}) == tmp_path / "aff-runtime"
    assert default_directory({"XDG_RUNTIME_DIR": str(tmp_path / "gone")}) == own
    assert default_directory({}) == own


@as_root
def test_the_session_of_another_user_is_not_ours_under_sudo(
    machine: Callable[..., Path], tmp_path: Path
) -> None:
    machine(user=False, folder=False)
    os.chown(tmp_path, NOBODY, NOBODY)
    assert default_directory({"XDG_RUNTIME_DIR": str(tmp_path)}) == Path("/tmp/aff-runtime-0")


# --- who answers ----------------------------------------------------------------------------

FAKE = {"ok": True, "line": "x", "state": "ACTIVE"}


@pytest.fixture
def place(tmp_path: Path) -> Path:
    folder = tmp_path / "rt"
    folder.mkdir(mode=0o700)
    return folder


@pytest.fixture
def liar(place: Path) -> Iterator[Path]:
    """A process of nobody's that listens in a folder of ours."""
    with answering(place / "control.sock", FAKE, become=NOBODY):
        yield place


@as_root
@pytest.mark.wire
@pytest.mark.parametrize("command", ["arm", "bypass", "status", "stop", "shadow"])
def test_a_listener_of_another_user_is_told_nothing_and_believed_nothing(
    liar: Path, command: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([command, "--runtime-dir", str(liar)]) == 4
    said = capsys.readouterr()
    assert said.out == ""
    assert f"uid {NOBODY} (nobody) listens there" in said.err
    assert "nothing was asked" in said.err


@pytest.mark.wire
def test_a_listener_who_is_none_of_those_trusted_is_refused(
    place: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as server:
        server.bind(str(place / "control.sock"))
        server.listen(1)
        ServiceClient(place / "control.sock").close()
        monkeypatch.setattr(request_client, "service_uids", frozenset)
        with pytest.raises(RefusedError, match="which is no service of ours"):
            ServiceClient(place / "control.sock")


@as_root
def test_a_folder_of_another_user_is_not_looked_into_and_its_owner_is_named(
    place: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    os.chown(place, NOBODY, NOBODY)
    assert main(["bypass", "--runtime-dir", str(place)]) == 4
    said = capsys.readouterr().err
    assert f"belongs to uid {NOBODY} (nobody)" in said
    assert f"sudo -u '#{NOBODY}' aff-runtime" in said


@pytest.mark.parametrize("bits", [0o777, 0o1777, 0o770])
def test_a_folder_in_which_anybody_could_listen_is_refused(place: Path, bits: int) -> None:
    place.chmod(bits)
    with pytest.raises(RefusedError, match="others may write in it"):
        ServiceClient(place / "control.sock")


@as_root
def test_a_closed_folder_of_the_service_says_how_to_get_in() -> None:
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:  # 0700; others see that it is there
        assert _as_nobody(Path(folder)) == 7


def _as_nobody(folder: Path) -> int:
    child = os.fork()
    if child == 0:
        os.setuid(NOBODY)
        try:
            ServiceClient(folder / "control.sock")
        except AffError as error:
            os._exit(7 if "sudo -u '#0' aff-runtime" in str(error) else 8)
        finally:
            os._exit(9)
    return os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])


# --- bypass is told only when it is seen ----------------------------------------------------


def shown(state: str, correction: float = 0.0, **more: Any) -> StatusAnswer:
    signals = {"correction_unwind_m_s": correction, "tick": 7.0}
    said = {"ok": True, "state": state, "signals": signals, "control_pid": 7, **more}
    return read_answer(said)


def test_bypass_waits_for_the_end_of_the_fade_and_then_says_so() -> None:
    answers = iter([shown("ACTIVE", 0.01), shown("BYPASS", 0.004), shown("BYPASS")])
    assert operate.after_bypass(lambda: next(answers), VirtualClock()) == "bypassed"
    assert next(answers, None) is None


@each_case(
    "stuck",
    [shown("ACTIVE", 0.01), shown("BYPASS", 0.01), shown("STARTING"), read_answer({"ok": True})],
)
def test_bypass_that_is_not_seen_is_not_claimed(stuck: StatusAnswer) -> None:
    clock = VirtualClock()
    with pytest.raises(RefusedError, match=r"still says \w+ after 5 s; .*at the PLC"):
        operate.after_bypass(lambda: stuck, clock)
    assert clock.now_ns() >= 5_000_000_000


def test_without_a_control_process_nothing_goes_out_and_that_is_what_is_said() -> None:
    said = operate.after_bypass(lambda: shown("FAULT", control_pid=0), VirtualClock())
    assert said.startswith("nothing goes out")
