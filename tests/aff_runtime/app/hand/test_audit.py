"""The chain: what is changed, taken out or put in is found; a full disk leaves whole lines."""

from __future__ import annotations

import errno
import hashlib
import json
import os
from collections.abc import Callable
from pathlib import Path

import pytest

from aff_runtime.app.hand.audit import KEPT_FILES, LONGEST_LINE, NAME, Audit, AuditEntry, verify
from aff_runtime.base.errors import ConfigError, RefusedError
from aff_runtime.cli.main import main


def audit(folder: Path, **more: int) -> Audit:
    return Audit(folder / "audit", now=lambda: "2026-11-23T08:00:00.000+00:00", **more)


def filled(folder: Path, lines: int, **more: int) -> Path:
    found = audit(folder, **more)
    for n in range(lines):
        found.add(AuditEntry(what="arm", result="done", account=f"a{n}"))
    found.close()
    return found.path


def test_each_line_holds_the_hash_of_the_one_before(tmp_path: Path) -> None:
    lines = filled(tmp_path, 3).read_bytes().splitlines()
    before = "0" * 64
    for number, line in enumerate(lines, start=1):
        row = json.loads(line)
        assert (row["n"], row["prev"]) == (number, before)
        before = hashlib.sha256(line).hexdigest()
    assert verify(tmp_path / "audit" / NAME).newest == before


FORGERIES: dict[str, Callable[[list[bytes]], list[bytes]]] = {
    "a word changed": lambda rows: [rows[0], rows[1].replace(b"a1", b"b1"), *rows[2:]],
    "one taken out": lambda rows: [rows[0], *rows[2:]],
    "the first taken out": lambda rows: [rows[1].replace(b'"n":2', b'"n":1'), *rows[2:]],
    "two exchanged": lambda rows: [rows[0], rows[2], rows[1], *rows[3:]],
    "one put in": lambda rows: [rows[0], rows[0], *rows[1:]],
    "no JSON": lambda rows: [rows[0], b"{", *rows[1:]],
    "a number that is none": lambda rows: [rows[0].replace(b'"n":1', b'"n":true'), *rows[1:]],
}


@pytest.mark.parametrize("forge", FORGERIES.values(), ids=FORGERIES)
def test_a_forgery_is_found_and_the_service_does_not_go_on_from_it(
    tmp_path: Path, forge: Callable[[list[bytes]], list[bytes]]
) -> None:
    path = filled(tmp_path, 5)
    path.write_bytes(b"\n".join(forge(path.read_bytes().splitlines())) + b"\n")
    assert verify(path).wrong
    with pytest.raises(RefusedError, match="does not hold"):
        audit(tmp_path)


def test_the_first_of_all_has_nothing_before_it(tmp_path: Path) -> None:
    path = filled(tmp_path, 1)
    path.write_bytes(path.read_bytes().replace(b"0" * 64, b"1" * 64))
    assert "something before it" in verify(path).wrong


def test_another_start_goes_on_and_only_one_writes(tmp_path: Path) -> None:
    path = filled(tmp_path, 2)
    first = audit(tmp_path)
    with pytest.raises(RefusedError, match="another service"):
        audit(tmp_path)
    assert first.add(AuditEntry(what="arm", result="asked")) == 3
    first.close()
    assert verify(path).last == 3


def test_half_a_line_is_cut_off_and_told(tmp_path: Path) -> None:
    path = filled(tmp_path, 2)
    path.write_bytes(path.read_bytes() + b'{"n":3,"utc')
    assert verify(path).wrong.endswith("half a line")
    audit(tmp_path).close()
    assert verify(path).last == 3
    assert "11 bytes" in json.loads(path.read_bytes().splitlines()[-1])["why"]


@pytest.mark.parametrize("content", [b"x" * 9000, b"\n" * 9000 + b"x" * 5000])
def test_what_is_no_audit_is_left_alone(tmp_path: Path, content: bytes) -> None:
    path = filled(tmp_path, 1)
    path.write_bytes(content)
    with pytest.raises(RefusedError, match=r"no audit of ours|does not hold"):
        audit(tmp_path, max_bytes=1000)
    assert path.read_bytes() == content


def test_it_is_bounded_and_the_chain_goes_through_its_files(tmp_path: Path) -> None:
    path = filled(tmp_path, 400, max_bytes=2000)
    files = sorted(path.parent.glob(f"{NAME}*"))
    assert len(files) == KEPT_FILES
    assert sum(file.stat().st_size for file in files) < KEPT_FILES * 2500
    chain = verify(path)
    assert (chain.wrong, chain.last) == ("", 400)
    assert chain.first > 1
    path.with_name(f"{NAME}.3").unlink()
    assert "does not follow" in verify(path).wrong


def test_a_file_that_was_just_begun_goes_on_from_the_older_one(tmp_path: Path) -> None:
    path = filled(tmp_path, 3)
    path.rename(path.with_name(f"{NAME}.1"))
    found = audit(tmp_path)
    assert found.add(AuditEntry(what="arm", result="done")) == 4
    found.close()
    assert verify(path).last == 4


def test_a_full_disk_leaves_whole_lines_and_is_told(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found = audit(tmp_path)
    found.add(AuditEntry(what="arm", result="done"))
    before, write = found.path.read_bytes(), os.write

    def half(descriptor: int, data: bytes) -> int:
        if descriptor == found._file and len(data) > 20:
            return write(descriptor, data[:20])
        raise OSError(errno.ENOSPC, "No space left on device")

    with monkeypatch.context() as full:
        full.setattr(os, "write", half)
        with pytest.raises(RefusedError, match="No space"):
            found.add(AuditEntry(what="arm", result="done"))
    assert found.path.read_bytes() == before
    assert found.add(AuditEntry(what="arm", result="done")) == 2
    found.close()
    assert verify(found.path).last == 2


def test_foreign_words_are_one_line_and_not_too_long(tmp_path: Path) -> None:
    found = audit(tmp_path)
    found.add(AuditEntry(what="arm", result="refused", why="a\nb\u202e" + "x" * 9999))
    found.close()
    (line,) = found.path.read_bytes().splitlines()
    assert json.loads(line)["why"].startswith(r"a\nb\u202e")
    assert len(line) < 1000


@pytest.mark.parametrize("leaves", ["nothing", "an empty file"])
def test_a_file_that_is_moved_away_meanwhile_leaves_no_line_unseen(
    tmp_path: Path, leaves: str
) -> None:
    found = audit(tmp_path)
    for _ in range(2):
        found.add(AuditEntry(what="arm", result="done"))
    found.path.rename(found.path.with_name(f"{NAME}.1"))
    if leaves == "an empty file":
        found.path.touch(0o600)
    assert found.add(AuditEntry(what="arm", result="done")) == 3
    found.close()
    chain = verify(found.path)
    assert (chain.first, chain.last, chain.wrong) == (1, 3, "")
    found.path.with_name(f"{NAME}.1").unlink()
    assert verify(found.path).first == 3


def test_another_file_in_its_place_is_not_written_to(tmp_path: Path) -> None:
    found = audit(tmp_path)
    found.add(AuditEntry(what="arm", result="done"))
    found.path.unlink()
    found.path.write_text("of somebody else\n")
    with pytest.raises(RefusedError, match="another file"):
        found.add(AuditEntry(what="arm", result="done"))
    assert found.path.read_text() == "of somebody else\n"
    found.path.unlink()
    assert found.add(AuditEntry(what="arm", result="done")) == 2
    found.close()


def test_the_widest_words_there_are_fit_a_line(tmp_path: Path) -> None:
    found = audit(tmp_path)
    wide = "\U0001f511"  # twelve bytes in JSON
    found.add(
        AuditEntry(what="arm", result="refused", why=wide * 300, peer=wide * 128, id="a" * 64)
    )
    found.close()
    assert 4096 < found.path.stat().st_size <= LONGEST_LINE


@pytest.mark.parametrize("spoil", ["a pipe", "a disk that fails"])
def test_what_cannot_be_read_is_refused_in_words(
    tmp_path: Path, spoil: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = filled(tmp_path, 1)

    def fails(*_: object) -> bytes:
        raise OSError(5, "Input/output error")

    if spoil == "a pipe":
        path.unlink()
        os.mkfifo(path, 0o600)
    else:
        monkeypatch.setattr(os, "pread", fails)
    with pytest.raises(RefusedError, match="no hand without it"):
        audit(tmp_path)


def test_a_folder_that_others_may_write_in_is_refused(tmp_path: Path) -> None:
    (tmp_path / "audit").mkdir(mode=0o777)
    (tmp_path / "audit").chmod(0o777)
    with pytest.raises(RefusedError, match="others"):
        audit(tmp_path)


def test_the_command_says_whether_the_chain_is_whole(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = filled(tmp_path, 2)
    assert main(["audit", "verify", str(path)]) == 0
    assert "2 lines, 1 to 2, from the first of all" in capsys.readouterr().out
    path.write_bytes(path.read_bytes().replace(b"a1", b"b1") + b"{}\n")
    assert main(["audit", "verify", str(path)]) == 5
    assert "does not hold" in capsys.readouterr().err
    assert main(["audit", "verify", str(tmp_path / "none")]) == ConfigError.exit_code
