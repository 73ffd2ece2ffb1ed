"""A card's file: an entry is there whole or not at all, whoever dies; two writers do not mix."""

import fcntl
import os
import signal
import sys

import pytest

from aff_runtime.app.card.book import LOCK, NAME, CardBook, card_file, content_of
from aff_runtime.app.card.chain import MAX_BYTES, follow
from aff_runtime.app.card.entries import Measured, entries_of
from aff_runtime.base.errors import ConfigError, RefusedError
from tests.aff_runtime.app.card.made import BEGUN_OF, add, book, measured, signed
from tests.processes import forked


def test_every_entry_comes_back_as_it_was_put_in(tmp_path):
    card = book(tmp_path / "card")
    first = measured(7, remarks=("a remark",), proposals=("x: 1",), missing=("more",))
    digest = add(card, first)
    add(card, signed(7, digest))
    said = [entry.content for entry in entries_of(card.read())]
    assert said == [BEGUN_OF, first, signed(7, digest)]


def test_bytes_of_before_are_never_touched(tmp_path):
    card = book(tmp_path)
    content = card.path.read_bytes()
    for step in range(5):
        add(card, measured(step))
        grown = card.path.read_bytes()
        assert grown.startswith(content)
        content = grown


def test_a_second_card_in_one_folder_is_refused(tmp_path):
    book(tmp_path)
    with pytest.raises(RefusedError, match="there is a card already"):
        book(tmp_path)


def test_what_does_not_hold_is_not_added_to(tmp_path):
    card = book(tmp_path)
    add(card, measured())
    spoilt = card.path.read_bytes().replace(b"120.0", b"121.0")
    card.path.write_bytes(spoilt)
    with pytest.raises(ConfigError, match="entry 2: its content does not have its hash"):
        add(card, measured())
    assert card.path.read_bytes() == spoilt


def test_an_entry_that_follows_another_hash_than_was_seen_is_refused(tmp_path):
    card = book(tmp_path)
    seen = card.read().newest
    add(card, measured())
    with pytest.raises(RefusedError, match="added to it meanwhile"):
        card.add("measured", {}, seen)


def test_one_writer_at_a_time(tmp_path):
    card = book(tmp_path)
    with (tmp_path / LOCK).open("r+") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(RefusedError, match="another command writes this card"):
            add(card, measured())


def test_a_file_that_cannot_be_a_card_is_refused_without_reading_it_all(tmp_path):
    path = tmp_path / NAME
    with path.open("wb") as file:
        file.truncate(MAX_BYTES + 1)
    with pytest.raises(ConfigError, match="no card of ours"):
        content_of(path)
    os.unlink(path)
    os.mkfifo(path)
    with pytest.raises(ConfigError, match="name a card's folder"):
        content_of(path)
    with pytest.raises(ConfigError, match="No such file"):
        CardBook(tmp_path / "none").read()


def test_a_card_is_named_by_its_file_or_its_folder(tmp_path):
    assert card_file(tmp_path) == card_file(tmp_path / NAME) == tmp_path / NAME


def write_on(folder, told):
    """Put entry after entry on a card and tell the hash of each, to the end of the process."""
    card = CardBook(folder, now=lambda: "2026")
    while True:
        digest = add(card, measured(3))
        print(digest, file=told, flush=True)
        print(add(card, signed(3, digest)), file=told, flush=True)


@pytest.mark.processes
@pytest.mark.parametrize("count", [1, 2, 5, 9])
def test_a_writer_that_is_killed_leaves_the_old_or_the_new_entry(tmp_path, count):
    """Killed at no chosen point: every entry that was told is there, the chain holds."""
    book(tmp_path)
    ours, theirs = os.pipe()
    with open(ours, encoding="utf-8") as heard, open(theirs, "w", encoding="utf-8") as told_to:
        writer = forked(lambda: write_on(tmp_path, told_to))
        told_to.close()
        told = [heard.readline() for _ in range(count)]
        os.kill(writer, signal.SIGKILL)
        os.waitpid(writer, 0)
        told += heard.readlines()
    chain = follow((tmp_path / NAME).read_bytes())
    assert chain.wrong == ""
    there = [link.sha256 for link in chain.links][1:]
    whole = [line.strip() for line in told if line.endswith("\n")]
    assert there[: len(whole)] == whole
    assert len(whole) >= count
    assert len(there) <= len(whole) + 1
    add(CardBook(tmp_path), measured(4))
    assert [name for name in os.listdir(tmp_path) if name.endswith(".new")] == []


def sign_and_die(folder, digest, at):
    """Sign in this process, and kill it at its ``at``-th call of the file system."""
    count = 0

    def stop(event, _):
        nonlocal count
        is_of_files = event in ("open", "os.rename", "os.remove", "os.listdir", "os.chmod")
        count += is_of_files
        if is_of_files and count == at:
            os.kill(os.getpid(), signal.SIGKILL)

    card = CardBook(folder, now=lambda: "2026")
    sys.addaudithook(stop)
    add(card, signed(3, digest))


@pytest.mark.processes
def test_killed_at_each_step_of_a_signature_the_card_is_whole(tmp_path):
    ends = [killed_at(tmp_path / str(at), at) for at in range(1, 12)]
    assert {"old", "new", "not killed"} == set(ends)
    assert ends == sorted(ends, key=["old", "new", "not killed"].index)  # never back to the old


def killed_at(folder, at):
    """Kill a signature at its ``at``-th call of the file system; return what is there then."""
    card = book(folder)
    digest = add(card, measured(3))
    before = card.path.read_bytes()
    _, ended = os.waitpid(forked(lambda: sign_and_die(folder, digest, at)), 0)
    assert ended in (0, signal.SIGKILL)
    after = card.path.read_bytes()
    chain = follow(after)
    assert chain.wrong == ""
    assert after == before or len(chain.links) == 3
    assert isinstance(entries_of(chain)[1].content, Measured)
    add(CardBook(folder), signed(3, digest))
    if ended == 0:
        return "not killed"
    return "old" if after == before else "new"
