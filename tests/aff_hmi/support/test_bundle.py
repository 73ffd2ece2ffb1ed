"""The support archive: what is promised is in it, nothing secret is, and it has a bound."""

from __future__ import annotations

import asyncio
import io
import json
import zipfile
from dataclasses import asdict

import pytest

pytest.importorskip("starlette")

from aff_hmi.see.events import Kind
from aff_hmi.support.bundle import FILES, MOST_BYTES, files_of, zipped
from aff_hmi.support.desk import KEPT_NS
from aff_runtime.base.signals import State
from tests.aff_hmi.asgi import HOST, scope
from tests.aff_hmi.pressed import PASSWORD, Pressed

HOSTILE = '=cmd|"/c calc"!A1\u202e<script>../../etc\n'


def archive(at: Pressed) -> dict[str, bytes]:
    """Return the files of the archive as a browser gets them."""
    assert at.hub.sources is not None
    found = {}
    with zipfile.ZipFile(io.BytesIO(raw(at))) as whole:
        for info in whole.infolist():
            folder, _, name = info.filename.partition("/")
            assert folder == "aff-support"
            assert "/" not in name
            assert ".." not in name
            found[name] = whole.read(info)
    return found


def raw(at: Pressed) -> bytes:
    said = []

    async def send(message: object) -> None:
        said.append(message)

    async def receive() -> object:
        return {"type": "http.request", "body": b"", "more_body": False}

    made = scope("/data/support.zip", [("host", HOST)], "http", "GET")
    asyncio.run(at.gate(made, receive, send))  # type: ignore[arg-type]
    start, *rest = said
    assert start["status"] == 200  # type: ignore[index]
    return b"".join(one.get("body", b"") for one in rest)  # type: ignore[attr-defined]


def test_it_has_the_files_that_the_page_lists_and_no_other(keeping: Pressed) -> None:
    keeping.show(State.ACTIVE)
    found = archive(keeping)
    assert set(found) == set(FILES)
    assert json.loads(found["status.json"])["state"]
    assert json.loads(found["site.json"])["cycle_s"] == 0.005
    assert json.loads(found["version.json"])["screen"]
    assert b"aff_control_up" in found["metrics.txt"]
    assert json.loads(found["timing.json"])["times"]


def test_nothing_secret_is_in_it(keeping: Pressed) -> None:
    browser = keeping.browser("anna")
    session = browser.session()
    assert keeping.kept is not None
    keeping.kept.person("login", "anna")
    keeping.clock.advance_ns(10**9)
    keeping.show(State.READY)
    whole = b"\n".join(archive(keeping).values()).decode()
    secrets = [PASSWORD, browser.cookie.partition("=")[2], session.csrf]
    secrets += [session.account.secret, keeping.file.read_text().split()[-1]]
    for secret in secrets:
        assert str(secret) not in whole
    assert "anna" in whole  # who pressed something is in the events, as said


def test_hostile_words_print_and_are_no_formula(keeping: Pressed) -> None:
    assert keeping.kept is not None
    keeping.kept.journal.add(Kind.PERSON, HOSTILE, "{said}", said=HOSTILE, who=HOSTILE)
    keeping.show(State.READY)
    keeping.clock.advance_ns(10**9)
    keeping.show(State.READY)
    found = archive(keeping)
    text = found["events.csv"].decode()
    assert "\u202e" not in text
    assert ",=cmd" not in text
    assert ',"=cmd' not in text
    for name, one in found.items():
        assert "\u202e" not in one.decode(), name


def test_a_flood_gets_the_same_archive_for_ten_seconds(keeping: Pressed) -> None:
    keeping.show(State.READY)
    first = raw(keeping)
    assert all(raw(keeping) == first for _ in range(3))
    keeping.clock.advance_ns(KEPT_NS)
    keeping.wall_s += 10.0
    keeping.show(State.READY)
    assert raw(keeping) != first


def test_every_file_has_a_bound(keeping: Pressed) -> None:
    assert keeping.hub.sources is not None
    keeping.show(State.READY)
    sources = keeping.hub.sources
    part = sources.kept.alarms(str)
    files = files_of(
        sources.support._seen,
        alarms=part,
        events=[],
        timing=sources.timing.part(str),
        metrics="x" * (2 * MOST_BYTES),
        utc="2026-01-01T00:00:00+00:00",
    )
    assert len(files["metrics.txt"]) <= MOST_BYTES + 100
    assert files["metrics.txt"].endswith("1 MB]\n")
    assert zipped(files) == zipped(files)
    assert asdict(part)["alarms"] == ()
